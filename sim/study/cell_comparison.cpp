// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/cell_comparison.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>

#include "calib/error.h"
#include "calib/statistics/distributions.h"
#include "localise/place.h"
#include "sim/experiment.h"
#include "sim/study/one_at_a_time.h"
#include "sim/study/study.h"
#include "sim/study/success_interval.h"

namespace vernier::sim::internal {

using namespace vernier::internal;
using namespace localise;

namespace {

std::map<std::uint32_t, const TrialResult*> by_number(const CellResult& cell) {
  std::map<std::uint32_t, const TrialResult*> trials;
  for (const TrialResult& trial : cell.trials) trials[trial.trial] = &trial;
  return trials;
}

/// McNemar's exact p-value: the smaller count under Binomial(both counts, 1/2), both tails.
double exact_mcnemar(int only_a, int only_b) {
  const int discordant = only_a + only_b;
  if (discordant == 0) return 1;
  return std::min(1.0, 2 * binomial_cdf(std::min(only_a, only_b), discordant, 0.5));
}

}  // namespace

bool share_queries(const CellResult& a, const CellResult& b) {
  const std::map<std::uint32_t, const TrialResult*> trials_of_a = by_number(a);
  bool shared = false;
  for (const TrialResult& trial : b.trials) {
    const auto found = trials_of_a.find(trial.trial);
    if (found == trials_of_a.end()) continue;
    const Pose2D &p = found->second->truth, &q = trial.truth;
    if (p.x_m != q.x_m || p.y_m != q.y_m || p.heading_rad != q.heading_rad) return false;
    shared = true;
  }
  return shared;
}

PairedComparison compare(const CellResult& a, const CellResult& b) {
  if (!share_queries(a, b)) {
    throw Error("comparison of \"" + a.cell.label + "\" with \"" + b.cell.label + "\"",
                "the cells have no common queries",
                "compare cells with the same protocol and seed");
  }
  const std::map<std::uint32_t, const TrialResult*> trials_of_a = by_number(a);
  PairedComparison c;
  std::map<std::uint32_t, MapDifference> by_map;
  for (const TrialResult& trial : b.trials) {
    const auto found = trials_of_a.find(trial.trial);
    if (found == trials_of_a.end()) continue;
    const bool in_a = found->second->success(), in_b = trial.success();
    (in_a ? (in_b ? c.both : c.only_a) : (in_b ? c.only_b : c.neither))++;
    MapDifference& map = by_map[trial.trial / static_cast<std::uint32_t>(a.trials_per_block)];
    map.difference += in_a - in_b;
    map.discordant += in_a != in_b;
    ++map.trials;
  }
  std::vector<MapDifference> maps;
  maps.reserve(by_map.size());
  for (const auto& [block, map] : by_map) maps.push_back(map);
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
