// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/cell_comparison.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "calib/statistics/distributions.h"
#include "sim/study/block_outcomes.h"
#include "sim/study/one_at_a_time.h"
#include "sim/study/study.h"
#include "sim/study/success_interval.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

/// The blocks of b beside those of a with the same trials; both ascend.
std::vector<std::pair<const BlockOutcomes*, const BlockOutcomes*>> common_blocks(
    const CellResult& a, const CellResult& b) {
  std::vector<std::pair<const BlockOutcomes*, const BlockOutcomes*>> common;
  auto at = a.outcomes.begin();
  for (const BlockOutcomes& of_b : b.outcomes) {
    while (at != a.outcomes.end() && at->first < of_b.first) ++at;
    if (at == a.outcomes.end()) break;
    if (at->first == of_b.first && at->succeeded.size() == of_b.succeeded.size()) {
      common.emplace_back(&*at, &of_b);
    }
  }
  return common;
}

/// McNemar's exact p-value: the smaller count under Binomial(both counts, 1/2), both tails.
double exact_mcnemar(int only_a, int only_b) {
  const int discordant = only_a + only_b;
  if (discordant == 0) return 1;
  return std::min(1.0, 2 * binomial_cdf(std::min(only_a, only_b), discordant, 0.5));
}

}  // namespace

bool share_queries(const CellResult& a, const CellResult& b) {
  // Trials of other systems may have no pose that would tell them apart.
  if (!a.cell.system.is_localiser() && a.cell.experiment.seed != b.cell.experiment.seed) {
    return false;
  }
  const auto common = common_blocks(a, b);
  return !common.empty() && std::all_of(common.begin(), common.end(), [](const auto& pair) {
    return pair.first->queries == pair.second->queries;
  });
}

bool all_share_queries(const std::vector<CellResult>& cells) {
  return std::all_of(cells.begin(), cells.end(),
                     [&](const CellResult& cell) { return share_queries(cells.front(), cell); });
}

PairedComparison compare(const CellResult& a, const CellResult& b) {
  if (!share_queries(a, b)) {
    throw Error("comparison of \"" + a.cell.label + "\" with \"" + b.cell.label + "\"",
                "the cells have no common queries",
                "compare cells with the same protocol and seed");
  }
  PairedComparison c;
  std::vector<MapDifference> maps;
  for (const auto& [of_a, of_b] : common_blocks(a, b)) {
    MapDifference& map = maps.emplace_back();
    for (std::size_t i = 0; i < of_a->succeeded.size(); ++i) {
      const bool in_a = of_a->succeeded[i], in_b = of_b->succeeded[i];
      (in_a ? (in_b ? c.both : c.only_a) : (in_b ? c.only_b : c.neither))++;
      map.difference += in_a - in_b;
      map.discordant += in_a != in_b;
      ++map.trials;
    }
  }
  c.maps = static_cast<int>(maps.size());
  if (const std::optional<double> p = paired_p_value(maps)) {
    c.p_value = *p;
    c.mcnemar_p = exact_mcnemar(c.only_a, c.only_b);
  }
  return c;
}

std::vector<std::pair<std::size_t, std::size_t>> comparable_pairs(
    const std::vector<CellResult>& cells) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t b = 1; b < cells.size(); ++b) {
    const bool designed = has_design(cells[b].cell);
    for (std::size_t a = b; a-- > 0;) {
      if (designed && !is_reference_of(cells[a].cell, cells[b].cell)) continue;
      if (cells[a].cell.system.success_error != cells[b].cell.system.success_error) continue;
      if (!share_queries(cells[a], cells[b])) continue;
      pairs.emplace_back(a, b);
      break;
    }
  }
  return pairs;
}

std::vector<AdjustedComparison> compare_all(const std::vector<CellResult>& cells) {
  std::vector<AdjustedComparison> all;
  std::vector<double> p_values;
  for (const auto& [a, b] : comparable_pairs(cells)) {
    all.push_back({a, b, compare(cells[a], cells[b])});
    p_values.push_back(all.back().paired.p_value);
  }
  const std::vector<double> adjusted = holm_adjusted(p_values);
  for (std::size_t i = 0; i < all.size(); ++i) all[i].p_holm = adjusted[i];
  return all;
}

}  // namespace vernier::sim::internal
