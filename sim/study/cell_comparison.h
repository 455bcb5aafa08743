// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "sim/study/study.h"

namespace vernier::sim::internal {

/// Whether two cells asked in the same places: every trial that both have begins at the same pose,
/// and there is one. Not so where the seed or the protocol of the queries is swept.
bool share_queries(const CellResult& a, const CellResult& b);

/// Two cells on the same trials: in how many both succeeded, one alone, neither. The p-values are
/// those of "neither is better", not a number for fewer than six maps.
struct PairedComparison {
  int both = 0, only_a = 0, only_b = 0, neither = 0;
  int maps = 0;
  double p_value = std::numeric_limits<double>::quiet_NaN();    ///< paired t over maps
  double mcnemar_p = std::numeric_limits<double>::quiet_NaN();  ///< exact, as if independent
};

/// Throws Error where the cells do not share their queries.
PairedComparison compare(const CellResult& a, const CellResult& b);

/// Pairs of cells worth a comparison: each with the nearest one before it that shares its queries.
std::vector<std::pair<std::size_t, std::size_t>> comparable_pairs(
    const std::vector<CellResult>& cells);

}  // namespace vernier::sim::internal
