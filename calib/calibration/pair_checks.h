// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calib/calibration/observation_checks.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"

namespace vernier::internal {

/// Looks at matched pairs with a rough rig in hand before they are solved; `covariance` says how
/// rough, over all parameters of the rig (calib/rig.h). Throws Error where a quarter of an image
/// pair's corners lie behind the rig by more than 3 px and three of the standard deviations that
/// the rig allows them, and do not once left and right are exchanged; names the image pairs. Throws
/// Error where a pixel has no ray in the rough rig.
void check_sides(const PairObservations& pairs,
                 const Rig& rig,
                 const Eigen::MatrixXd& covariance,
                 const std::string& place = "");

/// Looks at the scene with the solved rig; the noise of the pairs is `sigma_scale` times what they
/// state. Doubts: the corners of every image pair lie on one
/// plane, or farther than parallax can tell (a homography explains 95 % of them within their
/// noise), which leaves more directions unseen (unobservable_directions,
/// calib/estimate/observability.h). Warnings: most image pairs do.
ObservationDiagnosis check_scene(const PairObservations& pairs,
                                 const Rig& rig,
                                 double sigma_scale = 1);

}  // namespace vernier::internal
