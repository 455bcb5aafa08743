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

/// What the error of a rig does to the images that it rectifies, pixel by pixel.
///
/// A raw pixel pair of one point, whatever rig reads it, stands at (x, y) and (x − d, y − dy) in
/// the images rectified by that rig. Its disparity errors are then those of
///
///     d = u_left − u_right,   dy = v_left − v_right,   (δd, δdy) = J δa
///
/// with a the rig's parameters in the order and tangent of calib/rig.h, and their covariance is
/// J C Jᵀ. With rays r of a raw pixel (calib/camera.h), X the rectifying rotation of the left
/// camera and y the rectified ray,
///
///     y_left = X r_left,   y_right = X Rᵀ r_right,   u = f y_x / y_z + c_x,   v = f y_y / y_z +
///     c_y
///
/// and all of them are derived: the rays by the intrinsics (at a fixed pixel, δr = −P⁻¹ ∂project
/// δa), R and, through the baseline and the axes that X is made of, X by the pose. f and c stay,
/// for they are chosen. The errors are common to all pixels of a rig: those of two pixels are
/// correlated by J₁ C J₂ᵀ, hardly less than fully where they are near.
///
/// Exact to first order. A change of the baseline's length alone does nothing to them (it scales
/// all depths), nor, for cameras side by side, does moving both centres alike.
class RectificationUncertainty {
 public:
  using Derivatives = Eigen::Matrix<double, 2, Eigen::Dynamic>;

  /// Throws Error unless the covariance is of the rig's parameters. `geometry` is the rig's own.
  RectificationUncertainty(const Rig& rig,
                           const Eigen::MatrixXd& covariance,
                           const RectifiedGeometry& geometry);

  /// ∂(d, dy) / ∂a for a raw pixel pair; for one that the rig itself predicts dy is 0. Nothing
  /// where a pixel has no ray, or none in front of its rectified camera.
  std::optional<Derivatives> by_rig(const PixelPair& raw) const;

  /// The raw pair of a rectified left pixel and its disparity, and what by_rig() says of it.
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
  /// Rows of X as they change with (w, t) of the right camera.
  Eigen::Matrix<double, 3, 6> x_by_pose_, y_by_pose_, z_by_pose_;
};

/// Variance of the disparity at which an edge is found, px². An edge with unit normal n runs on
/// through the rows; when what belongs to row y of the left image lies dy higher in the right one
/// (dy = v_left − v_right), the edge crosses row y there at u_right − (n_y / n_x) dy, so that
///
///     δd_edge = δd + (n_y / n_x) dy
///     σ²_edge = σ_d² + 2 (n_y / n_x) σ_d,dy + (n_y / n_x)² σ_dy²
///
/// With θ the angle of the edge's direction (cos θ, sin θ) to the row, y down, n_y / n_x = −cot θ:
/// for dy' = v_right − v_left this is σ_d² + 2 cot θ σ_d,dy' + cot² θ σ_dy'². The sign of n does
/// not matter. Infinite for an edge along the row. The edge is taken to run alike in both images,
/// which is so for a small disparity gradient.
double disparity_variance_px2(const Eigen::Matrix2d& covariance_px2,
                              const Eigen::Vector2d& edge_normal);

}  // namespace vernier::stereo::internal
