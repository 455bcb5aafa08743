// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/rig.h"
#include "calib/triangulation.h"
#include "stereo/rectification.h"
#include "stereo/rectification/raw_pixels.h"

namespace vernier::stereo::internal {

/// Propagates the error of a rig to the images rectified with it, per pixel.
///
/// The raw pixel pair of one point maps to (x, y) and (x − d, y − dy) in the images rectified with
/// any given rig. The errors are those of
///
///     d = u_left − u_right,   dy = v_left − v_right,   (δd, δdy) = J δa
///
/// with a the rig's parameters in the order and tangent of calib/rig.h, and their covariance is J C
/// Jᵀ. With rays r of a raw pixel (calib/camera.h), X the rectifying rotation of the left camera
/// and y the rectified ray,
///
///     y_left = X r_left,   y_right = X Rᵀ r_right
///     u = f y_x / y_z + c_x,   v = f y_y / y_z + c_y
///
/// the derivatives include the rays by the intrinsics (at a fixed pixel, δr = −P⁻¹ ∂project δa), R,
/// and, through the baseline and the axes that define X, X by the pose. f and c are chosen and
/// hence constant. The errors are common to all pixels of a rig: those of two pixels have the
/// covariance J₁ C J₂ᵀ and are almost fully correlated if the pixels are close.
///
/// Exact to first order. A change of the baseline's length alone has no effect (it scales all
/// depths), nor, for parallel cameras, has a common shift of both principal points.
class RectificationUncertainty {
 public:
  using Derivatives = Eigen::Matrix<double, 2, Eigen::Dynamic>;

  /// Throws Error unless the covariance has the size of the rig's parameters. `geometry` belongs to
  /// the rig.
  RectificationUncertainty(const Rig& rig,
                           const Eigen::MatrixXd& covariance,
                           const RectifiedGeometry& geometry);

  /// ∂(d, dy) / ∂a for a raw pixel pair; for a pair predicted by the rig itself dy is 0. Returns
  /// nullopt if a pixel cannot be unprojected, or its ray is not in front of its rectified camera.
  std::optional<Derivatives> by_rig(const PixelPair& raw) const;

  /// by_rig() for the raw pair of a rectified left pixel and its disparity.
  std::optional<Derivatives> by_rig(const Eigen::Vector2d& left_px, double disparity_px) const;

  /// J C Jᵀ, px²: variance of d, of dy and their covariance.
  std::optional<Eigen::Matrix2d> covariance_px2(const Eigen::Vector2d& left_px,
                                                double disparity_px) const;

  const Eigen::MatrixXd& rig_covariance() const { return covariance_; }

 private:
  Rig rig_;
  Eigen::MatrixXd covariance_;
  RectifiedGeometry geometry_;
  RawPixels raw_left_, raw_right_;
  /// Derivatives of the rows of X by (w, t) of the right camera.
  Eigen::Matrix<double, 3, 6> x_by_pose_, y_by_pose_, z_by_pose_;
};

/// Variance of the disparity measured at an edge, px². If the content of row y of the left image
/// lies dy higher in the right image (dy = v_left − v_right), an edge with unit normal n crosses
/// row y there at u_right − (n_y / n_x) dy, so that
///
///     δd_edge = δd + (n_y / n_x) dy
///     σ²_edge = σ_d² + 2 (n_y / n_x) σ_d,dy + (n_y / n_x)² σ_dy²
///
/// With θ the angle of the edge's direction (cos θ, sin θ) to the row, y down, n_y / n_x = −cot θ:
/// for dy' = v_right − v_left this is σ_d² + 2 cot θ σ_d,dy' + cot² θ σ_dy'². The sign of n does
/// not matter. Infinite for an edge along the row. Assumes that the edge has the same direction in
/// both images, which holds for a small disparity gradient.
double disparity_variance_px2(const Eigen::Matrix2d& covariance_px2,
                              const Eigen::Vector2d& edge_normal);

}  // namespace vernier::stereo::internal
