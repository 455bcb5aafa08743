// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

#include "sim/experiment.h"
#include "sim/study/study.h"
#include "sim/study/study_store.h"

namespace vernier::sim::internal {

/// The stored blocks of a study one by one, so that any number of trials takes no memory.
class BlockStream {
 public:
  /// Keeps a reference to `study`. Throws Error as study_results() does.
  BlockStream(const Study& study, const std::filesystem::path& folder);

  /// Number of trials that for_each() will give.
  std::size_t trials() const;

  /// Number of trials of the finished study.
  std::size_t wanted() const;

  using Visit =
      std::function<void(std::size_t cell, int block, const std::vector<TrialResult>& trials)>;

  /// Every finished block, by cell in the study's order and by number. Throws Error if one is
  /// damaged, or two stores disagree.
  void for_each(const Visit& visit) const;

 private:
  const Study& study_;
  std::vector<StoreReader> stores_;
};

}  // namespace vernier::sim::internal
