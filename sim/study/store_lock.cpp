// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/store_lock.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <string>

#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "sim/study/host_name.h"

namespace vernier::sim::internal {

namespace {

/// Magic numbers of statfs(2); <linux/magic.h> lacks some of them.
constexpr std::array<unsigned long, 17> local_file_systems{
    0xef53,      // ext2, ext3, ext4
    0x58465342,  // XFS
    0x9123683e,  // Btrfs
    0x2fc12fc1,  // ZFS
    0xca451a4e,  // bcachefs
    0xf2f52010,  // F2FS
    0x3153464a,  // JFS
    0x52654973,  // ReiserFS
    0x3434,      // NILFS
    0x01021994,  // tmpfs
    0x858458f6,  // ramfs
    0x794c7630,  // overlayfs
    0x4d44,      // FAT
    0x2011bab0,  // exFAT
    0x7366746e,  // NTFS in the kernel
    0x5346544e,  // the older one
    0xf15f,      // eCryptfs
};

enum class Locked { ours, of_another, not_at_all };

/// A lock on the whole file that belongs to the descriptor: a second one in this process is refused
/// too, and closing another descriptor of the file does not drop it.
Locked lock_whole(int descriptor) {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  if (::fcntl(descriptor, F_OFD_SETLK, &whole) == 0) return Locked::ours;
  return errno == EAGAIN || errno == EACCES ? Locked::of_another : Locked::not_at_all;
}

std::string words_in(int descriptor) {
  std::array<char, 200> text{};
  const ssize_t bytes = ::pread(descriptor, text.data(), text.size(), 0);
  std::string words(text.data(), bytes > 0 ? static_cast<std::size_t>(bytes) : 0);
  words.resize(std::min(words.find('\n'), words.size()));
  return words.empty() ? "another process" : vernier::internal::printable(words, 100);
}

/// False if it could not be written, as on a full disk.
bool write_who(int descriptor) {
  const std::string words = "process " + std::to_string(::getpid()) + " on " + host_name() + "\n";
  return ::ftruncate(descriptor, 0) == 0 &&
         ::pwrite(descriptor, words.data(), words.size(), 0) == static_cast<ssize_t>(words.size());
}

/// Whether the name still belongs to the open file, which another process may have removed.
bool still_named(int descriptor, const std::filesystem::path& file) {
  struct stat open {};
  struct stat named {};
  return ::fstat(descriptor, &open) == 0 && ::lstat(file.c_str(), &named) == 0 &&
         open.st_ino == named.st_ino && open.st_dev == named.st_dev;
}

}  // namespace

bool on_local_disk(const std::filesystem::path& file) {
  std::filesystem::path folder = file.parent_path();
  if (folder.empty()) folder = ".";
  struct statfs disk {};
  if (::statfs(folder.c_str(), &disk) != 0) return false;
  const auto type = static_cast<unsigned long>(disk.f_type) & 0xffffffffUL;
  return std::find(local_file_systems.begin(), local_file_systems.end(), type) !=
         local_file_systems.end();
}

StoreLock::StoreLock(const std::filesystem::path& store) : file_(store.string() + ".lock") {
  for (;;) {
    descriptor_ =
        ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (descriptor_ < 0) {
      throw Error(store.string(), std::string("cannot be written: ") + std::strerror(errno),
                  "check the folder's permissions, or choose another folder");
    }
    const Locked locked = lock_whole(descriptor_);
    if (locked == Locked::ours && still_named(descriptor_, file_)) break;
    const std::string reason = std::strerror(errno);
    const std::string holder = locked == Locked::of_another ? words_in(descriptor_) : "";
    ::close(descriptor_);
    if (locked == Locked::of_another) {
      throw Error(store.string(), "is being written by " + holder,
                  "wait until that has ended, or run another --shard");
    }
    if (locked == Locked::not_at_all) {
      throw Error(store.string(), "cannot be locked: " + reason,
                  "choose a folder on a disk that has locks");
    }
  }
  if (!write_who(descriptor_)) {
    ::unlink(file_.c_str());
    ::close(descriptor_);
    throw Error(store.string(), "cannot be written: the disk is full or faulty",
                "free some space and run the same command again");
  }
}

StoreLock::~StoreLock() {
  ::unlink(file_.c_str());
  ::close(descriptor_);
}

}  // namespace vernier::sim::internal
