// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calib/board_observations.h"

namespace vernier::internal {

/// Places in a view of the up to `count` corners nearest to its corner `i` on the board, nearest
/// first, without `i` and those that are `out` (one flag per corner; empty: none is).
std::vector<std::size_t> nearest_corners(const std::vector<Eigen::Vector3d>& target_m,
                                         const BoardView& view,
                                         std::size_t i,
                                         std::size_t count,
                                         const std::vector<bool>& out = {});

}  // namespace vernier::internal
