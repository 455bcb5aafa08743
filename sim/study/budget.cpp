// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/budget.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "calib/interval.h"
#include "calib/statistics/confidence_sequence.h"
#include "sim/study/success_interval.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

std::string_view name(BudgetState state) {
  switch (state) {
    case BudgetState::narrow:
      return "narrow enough";
    case BudgetState::spent:
      return "all trials";
    case BudgetState::going_on:
      break;
  }
  return "going on";
}

Interval anytime_interval_95(std::span<const ClusterCount> maps) {
  std::vector<double> rates;
  rates.reserve(maps.size());
  for (const ClusterCount& map : maps) {
    if (map.trials > 0) rates.push_back(static_cast<double>(map.successes) / map.trials);
  }
  return confidence_sequence(rates);
}

BudgetDecision budget_decision(std::span<const ClusterCount> first_blocks,
                               int all,
                               std::optional<double> interval_width) {
  const int there = std::min(all, static_cast<int>(first_blocks.size()));
  int wanted = interval_width ? std::min(all, fewest_maps) : all;
  while (wanted < all) {
    if (wanted > there) return {BudgetState::going_on, wanted};
    const Interval i = anytime_interval_95(first_blocks.first(static_cast<std::size_t>(wanted)));
    if (i.high - i.low <= *interval_width) return {BudgetState::narrow, wanted};
    wanted = std::min(all, (5 * wanted + 3) / 4);
  }
  if (all > there) return {BudgetState::going_on, all};
  if (!interval_width) return {BudgetState::spent, all};
  const Interval i = anytime_interval_95(first_blocks.first(static_cast<std::size_t>(all)));
  return {i.high - i.low <= *interval_width ? BudgetState::narrow : BudgetState::spent, all};
}

}  // namespace vernier::sim::internal
