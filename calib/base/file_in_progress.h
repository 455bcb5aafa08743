// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace vernier::internal {

/// A file that is being written and appears under its name complete or not at all.
///
/// The bytes go to a hidden temporary file `.vernier-*.tmp` of a random name in the folder of the
/// target, opened so that no existing file or link is followed; commit() syncs it, renames it to
/// the target and syncs the folder. Without commit() the destructor removes it and an old file
/// stays as it was. A target that is a symbolic link is followed; a replaced file hands on its
/// permissions. Every member that writes throws Error, naming the target.
class FileInProgress {
 public:
  /// Throws Error if the folder is missing or not writable, or the target is not a regular file.
  explicit FileInProgress(const std::filesystem::path& file);
  FileInProgress(FileInProgress&& other) noexcept;
  FileInProgress& operator=(FileInProgress&&) = delete;
  ~FileInProgress();

  void append(std::string_view bytes);
  /// Writes what is buffered, syncs and closes the temporary file. Nothing may be appended then.
  void finish();
  /// finish(), rename and sync of the folder.
  void commit();

  /// The target, links followed, and the name it has meanwhile.
  const std::filesystem::path& target() const { return target_; }
  const std::filesystem::path& temporary() const { return temporary_; }

 private:
  friend class OutputFiles;
  void write(std::string_view bytes);
  void take_over_permissions();
  void drop() noexcept;  // removes the temporary file

  std::filesystem::path target_, temporary_;
  std::string named_;   // the target as the caller names it, for messages
  std::string buffer_;  // not yet written
  int descriptor_ = -1;
};

/// Throws the Error that a FileInProgress of this name would, as far as it can be told without
/// making a file: for a fault that shall be found before the work whose result is written.
void check_writable_file(const std::filesystem::path& file);

/// Sync of a folder's entries; faults are ignored, since some file systems cannot.
void sync_folder(const std::filesystem::path& folder) noexcept;

/// A hidden name in `folder` that nobody can guess, for a temporary file.
std::filesystem::path temporary_name_in(const std::filesystem::path& folder);

}  // namespace vernier::internal
