// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "sim/experiment.h"
#include "sim/study/study.h"

namespace vernier::sim::internal {

/// Takes a cell's trials block by block and makes its figures of them, so that the trials need not
/// be kept: 24 bytes a trial are, and 8 for each quantity of another system, until the end, for
/// the quantiles.
class CellTally {
 public:
  /// Keeps a reference to the cell.
  explicit CellTally(CellResult& cell) : cell_(cell) {}

  /// The trials of a block, ascending; blocks ascend too. None: a block that is left out.
  void add(std::span<const TrialResult> block);
  /// Fills in the rest of CellResult::summary, by CellResult::maps too.
  void finish();

 private:
  void add(const TrialResult& trial);

  CellResult& cell_;
  int answered_ = 0, successes_ = 0, guesses_ = 0, node_ = 0, close_ = 0, closer_ = 0;
  double cpu_ms_ = 0, wall_ms_ = 0;                   // sums
  std::vector<double> errors_, turns_rad_, cpus_ms_;  // the first two of answers
  std::vector<std::vector<double>> measured_;         // known values of each
};

}  // namespace vernier::sim::internal
