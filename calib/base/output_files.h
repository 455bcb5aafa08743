// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <list>
#include <string_view>
#include <vector>

#include "calib/base/file_in_progress.h"

namespace vernier::internal {

/// The outputs of one action, all or none.
///
/// commit() completes and syncs every temporary file before the first gets its name; if a rename
/// fails, those before it are undone and the old files are back. Without commit() the destructor
/// removes the temporary files and the folders made. (A kill or a power cut between two renames may
/// leave some outputs new and some old, each complete; a replaced file is then left under a hidden
/// name `.vernier-*.tmp`.)
class OutputFiles {
 public:
  OutputFiles() = default;
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;
  ~OutputFiles();

  /// Makes the folder and its parents where missing. Throws Error if it cannot.
  void add_folder(const std::filesystem::path& folder);
  /// A file to append to until commit(); the reference stays valid. Throws Error as FileInProgress
  /// does, and if another output has the same name.
  FileInProgress& add(const std::filesystem::path& file);
  /// The same for an output that may not be wanted: null for an empty name.
  FileInProgress* add_wanted(const std::string& name) {
    return name.empty() ? nullptr : &add(name);
  }
  /// A whole file; it is closed, so that any number of them may be added.
  void add(const std::filesystem::path& file, std::string_view content);
  void commit();

 private:
  void put_in_place(FileInProgress& file);
  void undo() noexcept;
  void remove_folders() noexcept;

  struct Placed {
    std::filesystem::path target, old;  // `old`: where the replaced file is; empty if none was
  };

  std::list<FileInProgress> files_;
  std::vector<Placed> placed_;
  std::vector<std::filesystem::path> made_folders_;  // outermost first
};

/// Throws Error if files in `folder` could not be written, which is made with its parents where
/// missing, as far as it can be told without making anything.
void check_writable_folder(const std::filesystem::path& folder);

}  // namespace vernier::internal
