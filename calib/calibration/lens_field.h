// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/rig_prior.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {

/// Angle from the optical axis up to which corners are used with `fisheye4`: it takes x / z and
/// y / z, which are without bound towards 90 degrees.
inline constexpr double fisheye_field_deg = 89.5;
inline constexpr double fisheye_field_rad = fisheye_field_deg * std::numbers::pi / 180;

/// Whether a pixel shows what is further from the axis than `angle_rad`, below 90 degrees. False
/// for a model without such a limit, and where the polynomial of the angle does not rise up to
/// there: that is a fold.
bool is_beyond(const Camera& camera, const Eigen::Vector2d& pixel, double angle_rad);

/// Leaves out the corners that lie beyond the field of their lens model, and the images without
/// enough others: one such corner spoils its view, since the model puts it on the other side of the
/// image. Which ones is found by the pose of the board, whatever the pixel of the corner is: by
/// corners well within, at the minimum of `problem`, or where a frame has too few of them, by what
/// its pixels show within, with the rig of that minimum. Frames without such a pose are left out.
/// `state` is then the minimum of those that stay. Does nothing if all are within.
///
/// `held` are the parameters that `problem` holds, with their values. One or two warnings for each
/// camera that loses corners, or that may have such corners where no minimum is found.
void leave_out_beyond_field(BoardObservations& observations,
                            BoardState& state,
                            const std::vector<HeldParameter>& held,
                            ReprojectionProblem problem,
                            std::vector<std::string>& warnings);

}  // namespace vernier::internal
