// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "sim/study/study.h"

namespace vernier::sim::internal {

/// Whether two cells have the same queries: all trials of blocks that both contain start at the
/// same pose, and there is at least one. False if the seed or the query protocol is swept.
bool share_queries(const CellResult& a, const CellResult& b);
/// Whether all cells have the queries of the first.
bool all_share_queries(const std::vector<CellResult>& cells);

/// Two cells on the same trials: number in which both succeeded, only one, neither. The p-values
/// are for the null hypothesis that neither is better, NaN for fewer than six maps.
struct PairedComparison {
  int both = 0, only_a = 0, only_b = 0, neither = 0;
  int maps = 0;
  double p_value = std::numeric_limits<double>::quiet_NaN();  ///< paired t-test over maps
  /// Exact, as if trials were independent.
  double mcnemar_p = std::numeric_limits<double>::quiet_NaN();
};

/// Throws Error if the cells do not share their queries.
PairedComparison compare(const CellResult& a, const CellResult& b);

/// Pairs of cells to compare: each with the nearest earlier one that shares its queries; of the
/// designs of one_at_a_time.h, with its reference.
std::vector<std::pair<std::size_t, std::size_t>> comparable_pairs(
    const std::vector<CellResult>& cells);

/// Two of a study's cells, by index, and their p-value adjusted for the number of comparisons that
/// have one, by Holm's method (Scandinavian Journal of Statistics 6, 1979); NaN without one.
struct AdjustedComparison {
  std::size_t a = 0, b = 0;
  PairedComparison paired;
  double p_holm = std::numeric_limits<double>::quiet_NaN();
};

/// The comparisons of comparable_pairs().
std::vector<AdjustedComparison> compare_all(const std::vector<CellResult>& cells);

}  // namespace vernier::sim::internal
