// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/streams.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <string>

#include "calib/error.h"
#include "cli/program/ending_signals.h"

namespace vernier::cli {
namespace {

/// Waits for a descriptor that does not block; -1: for any time.
bool can_be_written(int descriptor, int wait_ms) {
  pollfd ready{descriptor, POLLOUT, 0};
  int state = 0;
  do {
    state = ::poll(&ready, 1, wait_ms);
  } while (state < 0 && errno == EINTR);
  return state > 0;
}

/// Returns errno, 0 if all was written.
int write_all(int descriptor, std::string_view text, int wait_ms) noexcept {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written > 0) {
      text.remove_prefix(static_cast<std::size_t>(written));
    } else if (written == 0) {
      return EIO;
    } else if (errno == EAGAIN) {
      if (!can_be_written(descriptor, wait_ms)) return EAGAIN;
    } else if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

std::atomic<bool>& silent() {
  static std::atomic<bool> flag = false;
  return flag;
}

bool is_open(int descriptor) { return ::fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF; }

}  // namespace

void open_missing_streams() noexcept {
  // open() takes the lowest free number, so in ascending order
  if (!is_open(STDIN_FILENO)) ::open("/dev/null", O_RDONLY);
  if (!is_open(STDOUT_FILENO)) ::open("/dev/null", O_RDONLY);  // writing to it fails
  if (!is_open(STDERR_FILENO)) ::open("/dev/null", O_WRONLY);
}

void be_silent() noexcept { silent() = true; }

void say(std::string_view text) noexcept {
  if (silent()) return;
  constexpr int longest_wait_ms = 1000;
  write_all(STDERR_FILENO, text, longest_wait_ms);
}

void print_result(std::string_view text) {
  const int fault = write_all(STDOUT_FILENO, text, -1);
  if (fault == 0) return;
  if (fault == EPIPE && !was_ignored(SIGPIPE)) end_by(SIGPIPE);
  throw Error(
      "standard output",
      std::string("cannot be written: ") + (fault == EBADF ? "it is closed" : std::strerror(fault)),
      "direct it elsewhere; output files, if there are any, have been written");
}

}  // namespace vernier::cli
