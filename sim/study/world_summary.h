// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calib/interval.h"
#include "sim/study/study.h"

namespace vernier::sim::internal {

/// Cells that differ in the world only, taken together.
struct WorldSummary {
  std::string label;               ///< the other swept keys and values; "all worlds" without any
  std::vector<std::size_t> cells;  ///< their indices
  int worlds = 0;                  ///< those with trials
  double success = 0;              ///< of all trials; 0 without trials
  /// For further worlds like these (success_interval.h).
  std::optional<Interval> success_interval_95;
  std::string why_no_interval;  ///< "needs 6 worlds, has 2"; empty if there is an interval
};

/// One summary for each group of two or more cells whose settings are the same but for
/// "world.file"; empty if no worlds are swept.
std::vector<WorldSummary> summarise_over_worlds(const std::vector<CellResult>& cells);

}  // namespace vernier::sim::internal
