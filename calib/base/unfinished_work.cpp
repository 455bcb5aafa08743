// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/unfinished_work.h"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <new>
#include <string>
#include <system_error>
#include <vector>

namespace vernier::internal {
namespace {

struct UnfinishedPath {
  std::string path;  // absolute
  Unfinished kind;
};

struct UnfinishedWork {
  std::recursive_mutex mutex;
  std::vector<UnfinishedPath> paths;
  std::vector<pid_t> children;
};

UnfinishedWork& work() {
  // Never destroyed: threads may outlive it. Not allocated: it is asked when memory has run out.
  alignas(UnfinishedWork) static std::byte place[sizeof(UnfinishedWork)];
  static UnfinishedWork* const only = new (place) UnfinishedWork;
  return *only;
}

/// Also where another thread, or a program that is about to end, adds to it meanwhile.
void remove_with_content(const std::string& folder) noexcept {
  constexpr int tries = 100;
  try {
    std::error_code ignored;
    for (int i = 0; i < tries && std::filesystem::exists(folder, ignored); ++i) {
      if (i > 0) ::usleep(1000);
      std::filesystem::remove_all(folder, ignored);
    }
  } catch (const std::bad_alloc&) {  // what is left is in a temporary folder
    return;
  }
}

std::string absolute_name(const std::filesystem::path& path) {
  std::error_code unknown;
  const std::filesystem::path whole = std::filesystem::absolute(path, unknown);
  return unknown ? path.string() : whole.string();
}

}  // namespace

void note_unfinished(const std::filesystem::path& path, Unfinished kind) {
  std::string name = absolute_name(path);
  const std::lock_guard lock(work().mutex);
  work().paths.push_back({std::move(name), kind});
}

void forget_unfinished(const std::filesystem::path& path) noexcept {
  const std::lock_guard lock(work().mutex);
  std::vector<UnfinishedPath>& paths = work().paths;
  const std::string name = absolute_name(path);
  const auto found = std::find_if(paths.rbegin(), paths.rend(),
                                  [&](const UnfinishedPath& one) { return one.path == name; });
  if (found != paths.rend()) paths.erase(std::next(found).base());
}

void note_child(pid_t child) {
  const std::lock_guard lock(work().mutex);
  work().children.push_back(child);
}

void forget_child(pid_t child) noexcept {
  const std::lock_guard lock(work().mutex);
  std::erase(work().children, child);
}

std::unique_lock<std::recursive_mutex> hold_off_abandoning() {
  return std::unique_lock(work().mutex);
}

void abandon_unfinished_work() noexcept {
  work().mutex.lock();  // for good
  for (const pid_t child : work().children) ::kill(-child, SIGKILL);
  const std::vector<UnfinishedPath>& paths = work().paths;
  for (std::size_t i = paths.size(); i-- > 0;) {  // what was made last first
    if (paths[i].kind == Unfinished::folder) {
      remove_with_content(paths[i].path);
    } else {
      std::remove(paths[i].path.c_str());  // a folder only if it is empty
    }
  }
}

}  // namespace vernier::internal
