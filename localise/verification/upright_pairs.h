// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "localise/verification/floor_plan_votes.h"

namespace vernier::localise::internal {

/// Vertical lines by columns, filled up with lines that are far away. Kernels are selected at run
/// time (calib/base/instruction_set.h).
struct UprightColumns {
  explicit UprightColumns(std::span<const PlanUpright> uprights);

  /// A part of the floor: positions p with along_low <= u . p <= along_high and
  /// |across - u x p| <= across_most for a unit vector u; metres.
  struct Strip {
    float ux, uy, along_low, along_high, across, across_most;
  };

  /// Indices of those that lie in a strip and may be parts of one line with `upright`
  /// (heights_agree), ascending. They lie in `room`.
  std::span<const std::int32_t> within(const Strip& strip,
                                       const PlanUpright& upright,
                                       std::vector<std::int32_t>& room) const;

  std::size_t size;
  std::vector<float> x_m, y_m, low_m, high_m;
};

/// Pairs of a query's line and a node's that may be one, by columns: positions in cells, the
/// node's relative to the pose around which votes are counted.
struct PairColumns {
  std::vector<float> query_x, query_y, node_x, node_y;

  void add(float qx, float qy, float nx, float ny);
  /// Fills up the columns with pairs that vote for nothing; needed after the last add().
  void pad();

  /// For a rotation, the pairs whose shift falls into the inner cells of a square of `side` cells
  /// around no shift: their number, the cells by rows, and their indices, ascending.
  std::size_t shift_cells(float cosine,
                          float sine,
                          int side,
                          std::vector<std::int32_t>& cells,
                          std::vector<std::int32_t>& indices) const;
};

}  // namespace vernier::localise::internal
