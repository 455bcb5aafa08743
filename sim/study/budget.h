// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "calib/interval.h"

namespace vernier::sim::internal {

/// How far a cell of a study with `interval_width` has to go. It has at most `trials`, and stops
/// before where the interval of its success rate is no wider than wanted. Whether it is, is asked
/// when the first 6, 8, 10, 13, 17 … (each a quarter more) of its blocks are all there, in this
/// order whoever computed them: the number of threads, ranks and shards and the order in which
/// they end decide nothing.
enum class BudgetState {
  going_on,  ///< blocks below `wanted` are missing
  narrow,    ///< stopped: the interval is narrow enough
  spent,     ///< stopped: all trials are used
};

std::string_view name(BudgetState state);

struct BudgetDecision {
  BudgetState state = BudgetState::going_on;
  int wanted = 0;  ///< blocks: the first so many are the results
};

/// The 95 % interval for a rule that stops by looking at it: the confidence sequence
/// (calib/statistics/confidence_sequence.h) of the maps' success rates, which are independent.
Interval anytime_interval_95(std::span<const ClusterCount> maps);

/// Decides from a cell's first blocks, as far as they are there without a gap; `all` is the number
/// of blocks of all its trials. Without a width all are wanted.
BudgetDecision budget_decision(std::span<const ClusterCount> first_blocks,
                               int all,
                               std::optional<double> interval_width);

}  // namespace vernier::sim::internal
