// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/board_observations.h"

namespace vernier::internal {

/// Throws Error for a target that is not flat: extent in z above a tenth of that in x and y.
void check_flat(const std::vector<Eigen::Vector3d>& target_m);

/// The homography from the board's plane (metres) to the image of one view, without any camera
/// model,
///
///     λ (u, v, 1)ᵀ = H (X, Y, 1)ᵀ
///
/// by the direct linear transformation on normalised points (Hartley and Zisserman, "Multiple View
/// Geometry", 2003, Alg. 4.2). Small deviations of the target from its plane are ignored.
struct BoardHomography {
  Eigen::Matrix3d H;
  double rms_px = 0;  ///< of the residuals, per coordinate; includes lens distortion
  /// Whether the board is seen from its front: x and y of the board have the same handedness as u
  /// and v, with corners numbered x right and y down. False for a mirrored image or numbering.
  bool is_front_facing = true;
};
BoardHomography board_homography(const std::vector<Eigen::Vector3d>& target_m,
                                 const BoardView& view);

/// Focal length (pixels) from the views' vanishing points, assuming square pixels and the principal
/// point at the image centre (Zhang 2000, Eqs. 3 and 4): with w = 1/f² every view gives two
/// equations a w + b = 0, solved in least absolute values for robustness against a bad view.
/// std::nullopt if the views do not determine it (boards parallel to the image).
std::optional<double> focal_length_px(const std::vector<BoardHomography>& views,
                                      const Eigen::Vector2i& size_px);

}  // namespace vernier::internal
