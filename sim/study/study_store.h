// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sim/experiment.h"

namespace vernier::sim::internal {

/// A completed block of trials of one cell.
struct StoredBlock {
  std::string cell;  ///< key: everything that its results depend on
  int block = 0;
  std::vector<TrialResult> trials;
};

/// Completed blocks in an SQLite file, one committed row per block. A killed process loses only the
/// block in progress. One writer per file.
class StudyStore {
 public:
  /// Opens or creates the file. Throws Error if it is not a store of this version, or was written
  /// on a processor with another instruction set (results would not be comparable to the bit).
  explicit StudyStore(const std::filesystem::path& file);
  ~StudyStore();
  StudyStore(StudyStore&&) noexcept;

  /// Adds or replaces a block; committed on return.
  void put(const StoredBlock& block);
  std::vector<StoredBlock> blocks() const;

  /// Text by key (the study's settings, the ceiling).
  void set_metadata(const std::string& key, const std::string& value);
  std::string note(const std::string& key) const;  ///< empty if there is none
  std::vector<std::pair<std::string, std::string>> notes() const;

 private:
  struct Connection;
  std::unique_ptr<Connection> connection_;
};

/// The longer of two versions of a block. Throws Error(`place`) if their common trials differ in
/// more than the timings.
StoredBlock longer_block(StoredBlock a, StoredBlock b, const std::string& place);

/// Store files of a study's folder, sorted by name.
std::vector<std::filesystem::path> store_files(const std::filesystem::path& folder);

}  // namespace vernier::sim::internal
