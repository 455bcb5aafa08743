// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"

namespace vernier::internal {

/// Angle from the optical axis up to which `fisheye4` has rays, radians: it takes x / z and y / z,
/// which are without bound towards 90 degrees.
inline constexpr double fisheye_field_rad = 89.5 * 3.14159265358979323846 / 180;

/// Whether a pixel shows what is further from the axis than `angle_rad`, below 90 degrees. False
/// for a model without such a limit, and where the polynomial of the angle does not rise up to
/// there: that is a fold.
bool is_beyond(const Camera& camera, const Eigen::Vector2d& pixel, double angle_rad);

/// Leaves out the corners that lie beyond the field of their lens model, and the images without
/// enough others: one such corner spoils its view, since the model puts it on the other side of the
/// image. Which ones is found by poses that corners well within determine, whatever the pixel of
/// the corner is. `state` is then the minimum of those that stay. Does nothing if all are within.
/// One warning for each camera that loses corners.
void leave_out_beyond_field(BoardObservations& observations,
                            BoardState& state,
                            std::vector<std::string>& warnings);

}  // namespace vernier::internal
