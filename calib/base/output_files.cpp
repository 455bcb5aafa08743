// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/output_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <set>
#include <string>
#include <system_error>

#include "calib/base/file_in_progress.h"
#include "calib/base/unfinished_work.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

namespace fs = std::filesystem;

bool exists_itself(const fs::path& file) {
  struct stat state {};
  return ::lstat(file.c_str(), &state) == 0;
}

/// The folder and its parents as far as they are not there, innermost first.
std::vector<fs::path> missing_folders(const fs::path& folder) {
  std::vector<fs::path> missing;
  fs::path whole = folder.has_filename() ? folder : folder.parent_path();
  std::error_code unknown;
  for (; !whole.empty() && !fs::exists(whole, unknown) && !unknown; whole = whole.parent_path()) {
    missing.push_back(whole);
  }
  return missing;
}

[[noreturn]] void throw_cannot_be_made(const fs::path& folder, int fault) {
  throw Error(folder.string(), std::string("cannot be made: ") + std::strerror(fault),
              "choose a folder that you may write to");
}

[[noreturn]] void throw_unusable(const fs::path& folder, const std::error_code& why) {
  throw Error(folder.string(), why ? "cannot be used: " + why.message() : "is no folder",
              "choose another name");
}

/// Gives the complete file `temporary` the name `target` of an existing file, which is kept under
/// the name returned. File systems differ in what they can: exchange, hard link, rename only.
/// Returns an empty path, with errno set, if it failed.
fs::path exchange(const fs::path& temporary, const fs::path& target) {
  if (fs::is_directory(fs::symlink_status(target))) {  // it would be exchanged too
    errno = EISDIR;
    return {};
  }
  if (::renameat2(AT_FDCWD, temporary.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0) {
    return temporary;
  }
  if (errno != EINVAL && errno != ENOSYS && errno != ENOTSUP) return {};
  const fs::path kept = temporary_name_in(target.parent_path());
  note_unfinished(kept, Unfinished::file);
  const bool linked = ::link(target.c_str(), kept.c_str()) == 0;
  if ((linked || ::rename(target.c_str(), kept.c_str()) == 0) &&
      ::rename(temporary.c_str(), target.c_str()) == 0) {
    forget_unfinished(temporary);
    return kept;
  }
  const int fault = errno;
  if (linked) ::unlink(kept.c_str());
  if (!linked && !exists_itself(target)) std::rename(kept.c_str(), target.c_str());
  forget_unfinished(kept);
  errno = fault;
  return {};
}

}  // namespace

OutputFiles::~OutputFiles() {
  files_.clear();
  remove_folders();
}

void OutputFiles::remove_folders() noexcept {
  for (auto made = made_folders_.rbegin(); made != made_folders_.rend(); ++made) {
    ::rmdir(made->c_str());
    forget_unfinished(*made);
  }
  made_folders_.clear();
}

void check_writable_folder(const fs::path& folder) {
  const std::vector<fs::path> missing = missing_folders(folder);
  fs::path there = missing.empty() ? folder : missing.back().parent_path();
  if (there.empty()) there = ".";
  std::error_code unknown;
  if (!fs::is_directory(there, unknown)) throw_unusable(folder, unknown);
  if (::faccessat(AT_FDCWD, there.c_str(), W_OK | X_OK, AT_EACCESS) == 0) return;
  if (!missing.empty()) throw_cannot_be_made(folder, errno);
  throw Error(folder.string(), std::string("cannot be written: ") + std::strerror(errno),
              "choose a folder that you may write to");
}

void OutputFiles::add_folder(const fs::path& folder) {
  const std::vector<fs::path> missing = missing_folders(folder);
  for (auto next = missing.rbegin(); next != missing.rend(); ++next) {
    const auto lock = hold_off_abandoning();
    if (::mkdir(next->c_str(), 0777) == 0) {
      note_unfinished(*next, Unfinished::empty_folder);
      made_folders_.push_back(*next);
    } else if (errno != EEXIST) {
      throw_cannot_be_made(folder, errno);
    }
  }
  std::error_code unknown;
  if (!fs::is_directory(folder, unknown)) throw_unusable(folder, unknown);
}

FileInProgress& OutputFiles::add(const fs::path& file) {
  FileInProgress next(file);
  std::error_code unknown;
  const auto folder = [](const fs::path& path) {
    return path.parent_path().empty() ? fs::path(".") : path.parent_path();
  };
  for (const FileInProgress& other : files_) {
    if (other.target().filename() == next.target().filename() &&
        fs::equivalent(folder(other.target()), folder(next.target()), unknown)) {
      throw Error(file.string(), "is already used by another output", "name another file");
    }
  }
  return files_.emplace_back(std::move(next));
}

void OutputFiles::add(const fs::path& file, std::string_view content) {
  FileInProgress& out = add(file);
  out.append(content);
  out.finish();
}

void OutputFiles::put_in_place(FileInProgress& file) {
  Placed placed{file.target(), {}};
  bool done = false;
  if (exists_itself(placed.target)) {
    placed.old = exchange(file.temporary_, placed.target);
    done = !placed.old.empty();
  } else {
    done = ::rename(file.temporary_.c_str(), placed.target.c_str()) == 0;
    if (done) forget_unfinished(file.temporary_);
  }
  if (!done) {
    throw Error(file.named_, std::string("cannot be written: ") + std::strerror(errno),
                "choose another name");
  }
  file.temporary_.clear();
  placed_.push_back(std::move(placed));
}

void OutputFiles::undo() noexcept {
  for (auto placed = placed_.rbegin(); placed != placed_.rend(); ++placed) {
    if (placed->old.empty()) {
      ::unlink(placed->target.c_str());
    } else {
      ::rename(placed->old.c_str(), placed->target.c_str());
      forget_unfinished(placed->old);
    }
  }
  placed_.clear();
}

void OutputFiles::commit() {
  for (FileInProgress& file : files_) file.finish();
  if (files_.size() == 1) {
    files_.front().commit();
  } else {
    const auto lock = hold_off_abandoning();
    placed_.reserve(files_.size());
    try {
      for (FileInProgress& file : files_) put_in_place(file);
    } catch (...) {
      undo();
      throw;
    }
    std::set<fs::path> folders;
    for (const Placed& placed : placed_) {
      if (!placed.old.empty()) {
        ::unlink(placed.old.c_str());
        forget_unfinished(placed.old);
      }
      folders.insert(placed.target.parent_path());
    }
    for (const fs::path& folder : folders) sync_folder(folder.empty() ? "." : folder);
  }
  for (const fs::path& made : made_folders_) forget_unfinished(made);
  made_folders_.clear();
  placed_.clear();
  files_.clear();
}

}  // namespace vernier::internal
