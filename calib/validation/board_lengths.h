// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <map>
#include <utility>
#include <vector>

#include "calib/board_observations.h"
#include "calib/triangulation.h"

namespace vernier::internal {

/// One frame seen by both cameras of a pair: pixels by corner.
using SeenPair = std::map<int, PixelPair>;

/// One per frame, empty where a camera did not see the board.
std::vector<SeenPair> seen_pairs(const BoardObservations& observations,
                                 const std::vector<int>& frames);

/// The longest pairs of these corners in each row, each column and along both diagonals of a board.
std::vector<std::pair<int, int>> board_edges(const std::vector<Eigen::Vector3d>& target_m,
                                             const std::vector<int>& ids);

}  // namespace vernier::internal
