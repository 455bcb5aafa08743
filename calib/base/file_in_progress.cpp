// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/file_in_progress.h"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <random>
#include <system_error>
#include <utility>

#include "calib/base/unfinished_work.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

constexpr std::size_t buffer_bytes = std::size_t(1) << 18;

/// The remedy for a fault of writing.
std::string remedy_for_fault(int fault) {
  if (fault == ENOSPC || fault == EDQUOT) return "free space there, or choose another folder";
  if (fault == EFBIG) return "raise the limit on the size of files (ulimit -f)";
  if (fault == ENOENT || fault == ENOTDIR) return "make its folder first";
  if (fault == EMFILE || fault == ENFILE) return "raise the limit on open files (ulimit -n)";
  if (fault == EACCES || fault == EPERM || fault == EROFS) {
    return "choose a folder that you may write to";
  }
  if (fault == ENAMETOOLONG) return "choose a shorter name";
  return "check the disk, or choose another folder";
}

[[noreturn]] void throw_write_fault(const std::string& file, int fault) {
  throw Error(file, std::string("cannot be written: ") + std::strerror(fault),
              remedy_for_fault(fault));
}

/// The file that `named` means, links followed. rename() would replace a link, a device or a pipe
/// by a regular file: what is not a regular file is refused.
std::filesystem::path followed(const std::filesystem::path& named) {
  struct stat state {};
  if (::stat(named.c_str(), &state) == 0 && !S_ISREG(state.st_mode)) {
    throw Error(named.string(),
                S_ISDIR(state.st_mode) ? "is a folder" : "exists and is not a regular file",
                S_ISDIR(state.st_mode) ? "name a file in it" : "choose another name");
  }
  std::filesystem::path file = named;
  constexpr int most_links = 40;
  std::error_code unknown;
  for (int links = 0; std::filesystem::is_symlink(file, unknown); ++links) {
    if (links == most_links) throw_write_fault(named.string(), ELOOP);
    file = file.parent_path() / std::filesystem::read_symlink(file, unknown);
  }
  if (!file.has_filename()) throw_write_fault(named.string(), named.empty() ? ENOENT : EISDIR);
  return file;
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.parent_path();
  return folder.empty() ? std::filesystem::path(".") : folder;
}

}  // namespace

void check_writable_file(const std::filesystem::path& file) {
  struct stat state {};
  if (::stat(file.c_str(), &state) != 0 && errno == ENAMETOOLONG) {
    throw_write_fault(file.string(), errno);
  }
  const std::filesystem::path folder = folder_of(followed(file));
  if (::stat(folder.c_str(), &state) == 0 && !S_ISDIR(state.st_mode)) {
    throw_write_fault(file.string(), ENOTDIR);
  }
  if (::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) != 0) {
    throw_write_fault(file.string(), errno);
  }
}

std::filesystem::path temporary_name_in(const std::filesystem::path& folder) {
  std::uint64_t number = 0;
  if (::getrandom(&number, sizeof number, 0) != static_cast<ssize_t>(sizeof number)) {
    number = (std::uint64_t(std::random_device{}()) << 32) ^ std::random_device{}();
  }
  char name[40];
  std::snprintf(name, sizeof name, ".vernier-%016llx.tmp", static_cast<unsigned long long>(number));
  return folder / name;
}

void sync_folder(const std::filesystem::path& folder) noexcept {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  while (::fsync(descriptor) != 0 && errno == EINTR) continue;
  ::close(descriptor);
}

FileInProgress::FileInProgress(const std::filesystem::path& file)
    : target_(followed(file)), named_(file.string()) {
  constexpr int tries = 100;
  for (int i = 0; i < tries && descriptor_ < 0; ++i) {
    temporary_ = temporary_name_in(folder_of(target_));
    const auto lock = hold_off_abandoning();
    note_unfinished(temporary_, Unfinished::file);
    descriptor_ = ::open(temporary_.c_str(),
                         O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC | O_NOCTTY, 0666);
    if (descriptor_ >= 0) return;
    const int fault = errno;
    forget_unfinished(temporary_);
    if (fault != EEXIST && fault != EINTR) throw_write_fault(named_, fault);
  }
  throw_write_fault(named_, EEXIST);
}

FileInProgress::FileInProgress(FileInProgress&& other) noexcept
    : target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, {})),
      named_(std::move(other.named_)),
      buffer_(std::move(other.buffer_)),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

FileInProgress::~FileInProgress() { drop(); }

void FileInProgress::drop() noexcept {
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
  if (temporary_.empty()) return;
  ::unlink(temporary_.c_str());
  forget_unfinished(temporary_);
  temporary_.clear();
}

void FileInProgress::write(std::string_view bytes) {
  while (!bytes.empty()) {
    constexpr std::size_t at_once = std::size_t(1) << 30;
    const ssize_t written =
        ::write(descriptor_, bytes.data(), bytes.size() < at_once ? bytes.size() : at_once);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) throw_write_fault(named_, written < 0 ? errno : ENOSPC);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void FileInProgress::append(std::string_view bytes) {
  if (buffer_.size() + bytes.size() < buffer_bytes) {
    buffer_ += bytes;
    return;
  }
  write(buffer_);
  buffer_.clear();
  write(bytes);
}

/// Owner and permissions of the file to replace. Where its group cannot be kept, the group gets
/// what everybody may do.
void FileInProgress::take_over_permissions() {
  struct stat old {};
  if (::stat(target_.c_str(), &old) != 0) return;
  mode_t mode = old.st_mode & 0777;
  struct stat own {};
  if (::fstat(descriptor_, &own) != 0) return;
  if (own.st_uid != old.st_uid || own.st_gid != old.st_gid) {
    if (::fchown(descriptor_, old.st_uid, old.st_gid) != 0 &&
        ::fchown(descriptor_, static_cast<uid_t>(-1), old.st_gid) != 0) {
      mode = (mode & ~mode_t(070)) | ((mode & 07) << 3 & mode);
    }
  }
  // a file system without permissions refuses; the file is none the worse
  if (::fchmod(descriptor_, mode) != 0) return;
}

void FileInProgress::finish() {
  if (descriptor_ < 0) return;
  write(buffer_);
  buffer_ = {};
  take_over_permissions();
  int fault = 0;
  while (::fsync(descriptor_) != 0) {
    if (errno == EINTR) continue;
    if (errno != EINVAL && errno != ENOTSUP && errno != ENOSYS) fault = errno;
    break;
  }
  // Linux closes the descriptor even where close() reports a fault
  if (::close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR && !fault) fault = errno;
  if (fault) throw_write_fault(named_, fault);
}

void FileInProgress::commit() {
  finish();
  {
    const auto lock = hold_off_abandoning();
    if (::rename(temporary_.c_str(), target_.c_str()) != 0) throw_write_fault(named_, errno);
    forget_unfinished(temporary_);
    temporary_.clear();
  }
  sync_folder(folder_of(target_));
}

}  // namespace vernier::internal
