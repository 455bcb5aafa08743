// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/board_observations.h"

namespace vernier::internal {

/// Frames in which the same cameras see the board.
struct FrameKind {
  std::vector<int> cameras;         ///< ascending
  std::vector<std::size_t> frames;  ///< indices into the frames that were given
};

/// The kinds among `frames` (ascending), that of the most cameras first. Frames without a view are
/// of none.
std::vector<FrameKind> frame_kinds(const BoardObservations& observations,
                                   const std::vector<int>& frames);

/// The shares that the kinds could have among all frames of which these are a sample: a draw from
/// Dirichlet's distribution with the numbers of frames, the posterior of Haldane's prior. One kind
/// has all.
std::vector<double> drawn_shares(const std::vector<FrameKind>& kinds,
                                 std::uint64_t seed,
                                 std::uint32_t number);

}  // namespace vernier::internal
