// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace vernier::sim::internal {

/// Whether a file would lie on a disk of this machine, by the type of the file system. False for
/// network disks (NFS, SMB, Lustre, GPFS, BeeGFS, FUSE, 9p, AFS, Ceph) and for any type that is not
/// known to be local: SQLite's WAL needs memory that all processes share.
bool on_local_disk(const std::filesystem::path& file);

/// The right to write a store, held by one process at a time: a lock on the file NAME.lock beside
/// it, which is removed at the end. The system drops the lock of a process that ends in any way, so
/// that a file left by a killed one is no obstacle.
class StoreLock {
 public:
  /// Throws Error naming the store and the process that holds it, or if the folder is not writable.
  explicit StoreLock(const std::filesystem::path& store);
  ~StoreLock();
  StoreLock(const StoreLock&) = delete;
  StoreLock& operator=(const StoreLock&) = delete;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace vernier::sim::internal
