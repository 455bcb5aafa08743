// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "calib/pair_observations.h"
#include "calib/rig.h"

namespace vernier::internal {

enum class SimulatedScene {
  volume,  ///< points anywhere in view between the two depths
  plane    ///< points of one tilted plane halfway between them
};

struct SimulatedPairsOptions {
  int image_pairs = 20;
  int pairs_per_image = 100;
  SimulatedScene scene = SimulatedScene::volume;
  double nearest_m = 1.5, farthest_m = 12;  ///< even in inverse depth
  double pixel_sigma_px = 0.3;              ///< of each coordinate; 0 for none
  double wrong_share = 0;                   ///< fraction of matches with a wrong right corner …
  double wrong_radius_px = 10;  ///< … drawn from a disc of this radius about the true one
};

/// Pairs that both cameras of `rig` see, with white noise, for tests and planning. The same seed
/// gives the same points; noise and wrong matches are drawn by trial. Throws Error if the cameras
/// hardly see the same space.
PairObservations simulate_pairs(const Rig& rig,
                                std::uint64_t seed,
                                std::uint32_t trial = 0,
                                const SimulatedPairsOptions& options = {});

}  // namespace vernier::internal
