// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/board_observations.h"

namespace vernier::internal {

/// Throws Error for a target that is not flat: more extent in z than a tenth of that in x and y.
void check_flat(const std::vector<Eigen::Vector3d>& target_m);

/// What one view says of the board without any camera model: the homography from the board's plane
/// (metres) to the image,
///
///     λ (u, v, 1)ᵀ = H (X, Y, 1)ᵀ
///
/// by the direct linear transformation on normalised points (Hartley and Zisserman, "Multiple View
/// Geometry", 2003, Alg. 4.2). Small departures of the target from its plane are left aside.
struct BoardHomography {
  Eigen::Matrix3d H;
  double rms_px = 0;  ///< of the residuals, per coordinate; lens distortion is in it
  /// Whether x, y of the board turn into each other as u, v do: a board seen from its front, its
  /// corners numbered x right and y down. A mirrored image or a mirrored numbering turns it round.
  bool is_front_facing = true;
};
BoardHomography board_homography(const std::vector<Eigen::Vector3d>& target_m,
                                 const BoardView& view);

/// Focal length (pixels) from the views' vanishing points with square pixels and the centre in the
/// middle of the image (Zhang 2000, Eqs. 3 and 4): with w = 1/f² every view gives two equations
/// a w + b = 0, solved in least absolute values, so that one bad view does no harm. Nothing where
/// the views determine none (boards parallel to the image).
std::optional<double> focal_length_px(const std::vector<BoardHomography>& views,
                                      const Eigen::Vector2i& size_px);

}  // namespace vernier::internal
