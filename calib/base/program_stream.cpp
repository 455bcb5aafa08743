// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/program_stream.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "calib/error.h"

namespace vernier::internal {
namespace {

void close_end(int& descriptor) {
  if (descriptor >= 0) ::close(descriptor);
  descriptor = -1;
}

}  // namespace

ProgramStream::ProgramStream() {
  bool made = ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends_.data()) == 0;
  if (!made) ends_ = {-1, -1};
  int why = errno;
  // Above the numbers of the standard streams, which may be closed here.
  for (int& end : ends_) {
    if (!made) break;
    const int high = ::fcntl(end, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    why = errno;
    close_end(end);
    end = high;
    made = high >= 0;
  }
  if (!made) {
    for (int& end : ends_) close_end(end);
    throw Error("program", std::string("no connection to it can be made: ") + std::strerror(why),
                "close other programs or raise the limit of open files");
  }
  ::fcntl(ends_[0], F_SETFL, O_NONBLOCK);
}

ProgramStream::~ProgramStream() {
  close_ours();
  close_theirs();
}

void ProgramStream::close_ours() { close_end(ends_[0]); }
void ProgramStream::close_theirs() { close_end(ends_[1]); }

}  // namespace vernier::internal
