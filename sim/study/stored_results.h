// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "sim/study/study_store.h"

namespace vernier::sim::internal {

/// What several stores of one study hold together.
struct StoredResults {
  std::map<std::pair<std::string, int>, StoredBlock> blocks;  ///< by cell and number
  StoreNotes notes;
  std::vector<std::filesystem::path> interrupted;  ///< stores that cannot be read yet

  /// Throws Error naming the file if it disagrees with what is there: on a trial, on a ceiling, on
  /// the processor's instruction set.
  void add(StoreContent content, const std::filesystem::path& file);

  /// Throws Error if a store could not be read.
  void require_all_read() const;
};

/// Those of a folder, read as read_store does.
StoredResults stored_results(const std::filesystem::path& folder);

}  // namespace vernier::sim::internal
