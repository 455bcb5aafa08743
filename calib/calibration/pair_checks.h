// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "calib/calibration/observation_checks.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"

namespace vernier::internal {

/// Matches of an image pair below which it is not judged by itself.
inline constexpr std::size_t fewest_judged_matches = 12;

/// Checks matched pairs with an approximate rig before solving; `covariance` is the rig's, over all
/// its parameters (calib/rig.h). Throws Error, naming the image pairs, if a quarter of an image
/// pair's corners lie behind the rig by more than 3 px and three of the standard deviations that
/// the rig allows, but not with left and right exchanged; and if a pixel has no ray in the
/// approximate rig.
void check_sides(const PairObservations& pairs,
                 const Rig& rig,
                 const Eigen::MatrixXd& covariance,
                 const std::string& place = "");

/// Checks the scene with the solved rig; the noise of the pairs is `sigma_scale` times their stated
/// noise. Trust warnings: the corners of every image pair lie on one plane, or too far away for
/// parallax (a homography explains 95 % of them within their noise), which leaves more directions
/// unobservable (unobservable_directions, calib/estimate/observability.h). Warnings: most image
/// pairs do.
ObservationDiagnosis check_scene(const PairObservations& pairs,
                                 const Rig& rig,
                                 double sigma_scale = 1);

}  // namespace vernier::internal
