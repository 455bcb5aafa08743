// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/mesh_files/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <exception>
#include <string>
#include <string_view>

#include "calib/error.h"

namespace vernier::sim::internal {

namespace {

constexpr char good = 'G', refused = 'R';
constexpr char between_parts = '\0';

void write_all(int to, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(to, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) ::_exit(1);
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

/// In the child: silent, without a core file, ended with its parent and at the limit.
[[noreturn]] void run(const std::function<std::string()>& work, double cpu_limit_s, int to) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGXCPU, SIGSEGV, SIGABRT, SIGFPE, SIGBUS}) {
    ::signal(signal, SIG_DFL);
  }
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const auto seconds = static_cast<rlim_t>(std::ceil(cpu_limit_s));
  const rlimit cpu{seconds, seconds + 1};
  ::setrlimit(RLIMIT_CPU, &cpu);
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  if (nowhere >= 0) {
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
  }
  std::string answer;
  try {
    answer = good + work();
  } catch (const Error& error) {
    answer =
        refused + error.place() + between_parts + error.fault() + between_parts + error.remedy();
  } catch (const std::exception& error) {
    answer = refused + std::string() + between_parts + "cannot be read: " + error.what() +
             between_parts + "check the file, or convert it to another format";
  }
  write_all(to, answer);
  ::_exit(0);
}

std::string read_all(int from) {
  std::string bytes;
  std::array<char, 65536> part;
  for (;;) {
    const ssize_t n = ::read(from, part.data(), part.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return bytes;
    bytes.append(part.data(), static_cast<std::size_t>(n));
  }
}

[[noreturn]] void fail_damaged_file(const std::string& place) {
  throw Error(place, "is damaged, or of a kind on which its reader fails",
              "check the file, or convert it to another format");
}

}  // namespace

std::string in_child_process(const std::function<std::string()>& work,
                             double cpu_limit_s,
                             const std::string& place) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw Error(place, "cannot be read, because no pipe could be made", "close other programs");
  }
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    run(work, cpu_limit_s, ends[1]);
  }
  ::close(ends[1]);
  if (child < 0) {
    ::close(ends[0]);
    throw Error(place, "cannot be read, because no process could be started",
                "close other programs");
  }
  const std::string answer = read_all(ends[0]);
  ::close(ends[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) {
    throw Error(place, "was not read: its reader was ended from outside, as where memory runs out",
                "try again where there is more memory, or export fewer details");
  }
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) {
    throw Error(place, fmt::format("was not read within {:g} s of CPU time", cpu_limit_s),
                "check the file, or convert it to another format");
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fail_damaged_file(place);
  return child_result(answer, place);
}

std::string child_result(const std::string& told, const std::string& place) {
  if (told.starts_with(good)) return told.substr(1);
  const std::size_t first = told.find(between_parts), second = told.rfind(between_parts);
  const bool has_parts = told.starts_with(refused) && first != std::string::npos;
  if (!has_parts || second < first + 2) fail_damaged_file(place);  // no fault
  const std::string where = told.substr(1, first - 1);
  throw Error(where.empty() ? place : where, told.substr(first + 1, second - first - 1),
              told.substr(second + 1));
}

}  // namespace vernier::sim::internal
