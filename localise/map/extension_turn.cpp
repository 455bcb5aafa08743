// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/map/extension_turn.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace vernier::localise::internal {

namespace {

bool lock(int descriptor) {
  while (::flock(descriptor, LOCK_EX) != 0) {
    if (errno != EINTR) return false;
  }
  return true;
}

/// Whether the name belongs to another file by now: who extends a map replaces its file.
bool was_replaced(int descriptor, const std::filesystem::path& file) {
  struct stat open {};
  struct stat named {};
  return ::fstat(descriptor, &open) == 0 && ::stat(file.c_str(), &named) == 0 &&
         (open.st_ino != named.st_ino || open.st_dev != named.st_dev);
}

}  // namespace

ExtensionTurn::ExtensionTurn(const std::filesystem::path& file) {
  for (;;) {
    descriptor_ = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (descriptor_ < 0 || !lock(descriptor_) || !was_replaced(descriptor_, file)) return;
    ::close(descriptor_);
  }
}

ExtensionTurn::~ExtensionTurn() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace vernier::localise::internal
