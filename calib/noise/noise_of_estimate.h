// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/noise/board_tests.h"
#include "calib/noise/camera_scales.h"
#include "calib/noise/component_tests.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/restricted_likelihood.h"
#include "calib/rig_estimate.h"

namespace vernier::internal {

/// The restricted likelihood of a calibration's corners, linearised at its rig and poses, with its
/// held parameters and priors. A board whose warp is not zero is assumed to have been estimated
/// with it, and its aspect where the summary holds it. The unknowns `board` of the board
/// (calib/noise/board_tests.h) come last among those of the rig. Of a target with more than 80
/// points, as many are used, evenly spaced by number. With CameraNoise::of_each the rows of cameras
/// whose residuals differ are scaled by these (camera_scales), so that what is larger in one camera
/// is not taken for what all see. Throws Error if the estimate has no evidence.
RestrictedLikelihood noise_likelihood(const RigEstimate& estimate,
                                      NoiseParts parts,
                                      const std::vector<BoardField>& board = {},
                                      CameraNoise cameras = CameraNoise::alike);

/// The components of a calibration's corner noise, and whether each is there: nothing where a part
/// was not fitted, or not tested.
struct CornerNoiseEstimate : TestedNoise {
  /// The frames and cameras whose motion stands out: each at 1 % over their number (Bonferroni), so
  /// that none of a set in which nothing moves is named in 99 % of such sets. Empty unless
  /// motions as a whole are there at 1 %.
  std::vector<FrameMotion> moved() const;
};

/// Each part that is in `tested` too is also fitted without, which takes as long again. With
/// CameraNoise::of_each white noise and field are those of a camera of scale 1.
CornerNoiseEstimate estimate_corner_noise(const RigEstimate& estimate,
                                          NoiseParts parts,
                                          NoiseParts tested = {.shape = true},
                                          CameraNoise cameras = CameraNoise::alike);

}  // namespace vernier::internal
