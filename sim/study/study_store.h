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

/// A finished block of trials of one cell.
struct StoredBlock {
  std::string cell;  ///< key: everything that its results depend on
  int block = 0;
  std::vector<TrialResult> trials;
};

/// Finished blocks in one SQLite file, one committed row a block. A process that is killed loses
/// the block it was at and nothing else. One writer a file.
class StudyStore {
 public:
  /// Opens or makes the file. Throws Error where it is no store of this version, or was written on
  /// a processor with another instruction set (results would not be of one kind).
  explicit StudyStore(const std::filesystem::path& file);
  ~StudyStore();
  StudyStore(StudyStore&&) noexcept;

  /// Adds or replaces; committed when this returns.
  void put(const StoredBlock& block);
  std::vector<StoredBlock> blocks() const;

  /// Free text by key (the study's settings, the ceiling).
  void set_metadata(const std::string& key, const std::string& value);
  std::string note(const std::string& key) const;  ///< empty where there is none
  std::vector<std::pair<std::string, std::string>> notes() const;

 private:
  struct Connection;
  std::unique_ptr<Connection> connection_;
};

/// The longer of two versions of one block. Throws Error(`place`) where their common trials differ
/// in more than their timings.
StoredBlock longer_block(StoredBlock a, StoredBlock b, const std::string& place);

/// Store files of a study's folder, in the order of their names.
std::vector<std::filesystem::path> store_files(const std::filesystem::path& folder);

}  // namespace vernier::sim::internal
