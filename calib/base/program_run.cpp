// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/program_run.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <thread>
#include <utility>

#include "calib/base/program_stream.h"
#include "calib/base/unfinished_work.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

/// What a program writes, as much as messages need: the beginning and the end of it.
class KeptOutput {
 public:
  void append(std::string_view bytes) {
    const std::size_t room = kept - std::min(kept, begin_.size());
    begin_ += bytes.substr(0, room);
    if (bytes.size() <= room) return;
    end_ += bytes.substr(room);
    if (end_.size() > 2 * kept) end_.erase(0, end_.size() - kept);
  }
  std::string text() const { return begin_ + end_; }

 private:
  static constexpr std::size_t kept = 64'000;
  std::string begin_, end_;
};

/// Reads what is there; false when there is nothing more to come.
bool read_available(int descriptor, KeptOutput& to) {
  std::array<char, 65536> buffer;
  const ssize_t got = ::read(descriptor, buffer.data(), buffer.size());
  if (got > 0) to.append({buffer.data(), static_cast<std::size_t>(got)});
  return got > 0 || (got < 0 && (errno == EAGAIN || errno == EINTR));
}

/// The signals that this process ignores or blocks are as usual in the program.
short with_usual_signals(posix_spawnattr_t& attributes) {
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  return POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF;
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  const char* const wanted = std::getenv("TMPDIR");
  const std::filesystem::path parent = wanted && *wanted ? wanted : "/tmp";
  std::string name = (parent / "vernier-XXXXXX").string();
  const auto lock = hold_off_abandoning();
  if (!::mkdtemp(name.data())) {
    throw Error(parent.string(),
                std::string("a temporary folder cannot be made in it: ") + std::strerror(errno),
                "set the environment variable TMPDIR to a folder that you may write to");
  }
  path_ = name;
  note_unfinished(path_, Unfinished::folder);
}

std::filesystem::path TemporaryFolder::write(const std::string& name,
                                             std::string_view content) const {
  std::filesystem::path file = path_ / name;
  std::ofstream out(file, std::ios::binary);
  errno = 0;
  out.write(content.data(), static_cast<std::streamsize>(content.size()));
  out.flush();
  if (out) return file;
  throw Error(file.string(),
              std::string("cannot be written: ") + std::strerror(errno ? errno : EIO),
              "set the environment variable TMPDIR to a folder with free space");
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  forget_unfinished(path_);
}

std::vector<std::string> command_words(const std::string& command, const std::string& place) {
  std::vector<std::string> words;
  bool in_word = false;
  char quote = 0;
  for (std::size_t i = 0; i < command.size(); ++i) {
    const char letter = command[i];
    if (quote == 0 && std::isspace(static_cast<unsigned char>(letter))) {
      in_word = false;
      continue;
    }
    if (!std::exchange(in_word, true)) words.emplace_back();
    if (letter == quote) {
      quote = 0;
    } else if (quote == 0 && (letter == '\'' || letter == '"')) {
      quote = letter;
    } else if (letter == '\\' && quote != '\'' && i + 1 < command.size()) {
      words.back() += command[++i];
    } else {
      words.back() += letter;
    }
  }
  if (quote != 0) {
    throw Error(place, std::string("unclosed quote ") + quote, "close it");
  }
  return words;
}

int spawn_program(const std::vector<std::string>& words,
                  posix_spawn_file_actions_t& actions,
                  pid_t& child) {
  posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  const short flags = with_usual_signals(attributes);
  posix_spawnattr_setflags(&attributes, static_cast<short>(flags | POSIX_SPAWN_SETPGROUP));
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  if (words.empty()) arguments.insert(arguments.begin(), const_cast<char*>(""));
  const auto lock = hold_off_abandoning();
  const int failed =
      posix_spawnp(&child, arguments[0], &actions, &attributes, arguments.data(), environ);
  if (!failed) note_child(child);
  posix_spawnattr_destroy(&attributes);
  return failed;
}

std::string ProgramRun::last_output_line() const {
  const std::string& text =
      error_output.find_first_not_of(" \r\n\t") == std::string::npos ? output : error_output;
  const std::size_t end = text.find_last_not_of(" \r\n\t");
  if (end == std::string::npos) return "no output";
  const std::size_t before = text.find_last_of("\r\n", end);
  constexpr std::size_t max_letters = 300;
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  std::string line = text.substr(begin, std::min(end + 1 - begin, max_letters));
  for (char& letter : line) {
    if (std::iscntrl(static_cast<unsigned char>(letter))) letter = ' ';
  }
  return line;
}

ProgramRun run_program(const std::vector<std::string>& words, double time_limit_s) {
  using Clock = std::chrono::steady_clock;
  ProgramRun run;
  ProgramStream output, complaint;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, output.theirs(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, complaint.theirs(), STDERR_FILENO);
  pid_t child = 0;
  run.start_error = spawn_program(words, actions, child);
  posix_spawn_file_actions_destroy(&actions);
  output.close_theirs();
  complaint.close_theirs();
  if (run.start_error) return run;

  constexpr double longest_s = 1e9;
  const auto end =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(
                         std::chrono::duration<double>(std::min(time_limit_s, longest_s)));
  KeptOutput said, complained;
  int status = -1;  // neither ended nor signalled
  bool has_ended = false;
  while (!has_ended) {
    has_ended = ::waitpid(child, &status, WNOHANG) != 0;
    if (!has_ended && time_limit_s > 0 && Clock::now() > end) {
      run.timed_out = true;
      ::kill(-child, SIGKILL);
      while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
      has_ended = true;
    }
    // What it left behind may hold the streams open: only what is there now counts.
    constexpr int most_reads = 1000;  // then it is time to look at the clock
    for (int reads = 0; reads < most_reads; ++reads) {
      std::array<pollfd, 2> ready{};
      ready[0] = {output.ours(), POLLIN, 0};
      ready[1] = {complaint.ours(), POLLIN, 0};
      if (::poll(ready.data(), ready.size(), has_ended ? 0 : 1) <= 0) break;
      if (ready[0].revents != 0 && !read_available(output.ours(), said)) output.close_ours();
      if (ready[1].revents != 0 && !read_available(complaint.ours(), complained)) {
        complaint.close_ours();
      }
    }
  }
  forget_child(child);
  if (WIFEXITED(status) && !run.timed_out) run.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) run.signal = WTERMSIG(status);
  run.output = said.text();
  run.error_output = complained.text();
  return run;
}

}  // namespace vernier::internal
