// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/program_conversation.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include "calib/base/program_run.h"
#include "calib/base/program_stream.h"
#include "calib/base/shown_text.h"
#include "calib/base/unfinished_work.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

using Clock = std::chrono::steady_clock;

int wait_ms(Clock::time_point end) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
  constexpr std::int64_t longest = 1'000'000;
  return static_cast<int>(std::clamp<std::int64_t>(left.count() + 1, 0, longest));
}

}  // namespace

ProgramConversation::ProgramConversation(const std::vector<std::string>& words) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input_.theirs(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output_.theirs(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, error_output_.theirs(), STDERR_FILENO);
  const int failed = spawn_program(words, actions, child_);
  posix_spawn_file_actions_destroy(&actions);
  if (failed) {
    child_ = 0;
    throw Error("program " + in_quotes(words.empty() ? "" : words[0]),
                std::string("cannot be started: ") + std::strerror(failed),
                "check its name, PATH and permissions");
  }
  for (ProgramStream* stream : {&input_, &output_, &error_output_}) stream->close_theirs();
}

ProgramConversation::~ProgramConversation() {
  if (child_ <= 0) return;
  ::kill(-child_, SIGKILL);
  while (::waitpid(child_, nullptr, 0) < 0 && errno == EINTR) continue;
  forget_child(child_);
}

bool ProgramConversation::take_line(std::string& answer) {
  const std::size_t end = pending_.find('\n', searched_);
  if (end == std::string::npos) {
    searched_ = pending_.size();
    return false;
  }
  answer = pending_.substr(0, end);
  if (!answer.empty() && answer.back() == '\r') answer.pop_back();
  pending_.erase(0, end + 1);
  searched_ = 0;
  return true;
}

/// Takes what there is; closes the stream at its end. Keeps the last `most_kept` bytes.
void ProgramConversation::read_from(ProgramStream& stream, std::string& to, std::size_t most_kept) {
  std::array<char, 65536> buffer;
  const ssize_t got = ::read(stream.ours(), buffer.data(), buffer.size());
  if (got == 0) stream.close_ours();
  if (got <= 0) return;
  to.append(buffer.data(), static_cast<std::size_t>(got));
  if (to.size() > most_kept) to.erase(0, to.size() - most_kept);
}

ProgramConversation::Outcome ProgramConversation::ask(std::string_view lines,
                                                      double time_limit_s,
                                                      std::string& answer) {
  constexpr double longest_s = 1e6;
  constexpr std::size_t kept_complaints = 4096;
  const auto end =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(
                         std::chrono::duration<double>(std::clamp(time_limit_s, 0.0, longest_s)));
  while (true) {
    if (lines.empty() && take_line(answer)) return Outcome::line;
    if (pending_.size() > longest_line) return Outcome::too_long;
    if (output_.ours() < 0 || (input_.ours() < 0 && !lines.empty())) return Outcome::ended;
    std::array<pollfd, 3> ready{{{output_.ours(), POLLIN, 0},
                                 {error_output_.ours(), POLLIN, 0},
                                 {lines.empty() ? -1 : input_.ours(), POLLOUT, 0}}};
    const int count = ::poll(ready.data(), ready.size(), wait_ms(end));
    if (count < 0 && errno != EINTR) return Outcome::ended;
    if (count == 0) return Outcome::timed_out;
    if (count < 0) continue;
    if (ready[1].revents != 0) read_from(error_output_, complaints_, kept_complaints);
    if (ready[0].revents != 0) read_from(output_, pending_, longest_line + 1);
    if (ready[2].revents != 0) {
      const ssize_t sent = ::send(input_.ours(), lines.data(), lines.size(), MSG_NOSIGNAL);
      if (sent > 0) lines.remove_prefix(static_cast<std::size_t>(sent));
      if (sent < 0 && errno != EAGAIN && errno != EINTR) input_.close_ours();
    }
  }
}

double ProgramConversation::cpu_s() const {
  clockid_t clock{};
  timespec spent{};
  if (child_ <= 0 || ::clock_getcpuclockid(child_, &clock) != 0) return 0;
  if (::clock_gettime(clock, &spent) != 0) return 0;
  return static_cast<double>(spent.tv_sec) + 1e-9 * static_cast<double>(spent.tv_nsec);
}

std::string ProgramConversation::last_complaint() const {
  ProgramRun run;
  run.error_output = complaints_;
  return complaints_.find_first_not_of(" \r\n\t") == std::string::npos ? ""
                                                                       : run.last_output_line();
}

}  // namespace vernier::internal
