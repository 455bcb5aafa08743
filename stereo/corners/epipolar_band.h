// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "calib/rig.h"

namespace vernier::stereo::internal {

/// A pixel with its covariance.
struct UncertainPixel {
  Eigen::Vector2d pixel_px;
  Eigen::Matrix2d covariance_px2;
};

/// A node of the epipolar curve: the right pixel of a point at inverse depth ρ on the left pixel's
/// ray.
struct BandNode {
  double inverse_depth = 0;  ///< 1 / z in the left camera frame, 1 / m
  Eigen::Vector2d pixel_px;  ///< q(ρ) in the raw (distorted) right image
  Eigen::Matrix2d covariance_px2 = Eigen::Matrix2d::Zero();  ///< of q(ρ)
  /// ∂q / ∂p at this ρ: how a surface at constant depth changes from the left to the right image.
  Eigen::Matrix2d right_by_left = Eigen::Matrix2d::Identity();
  bool follows = false;  ///< whether the curve is connected to the previous node
};

/// Distance of a right pixel from the curve.
struct BandDistance {
  double mahalanobis2 = std::numeric_limits<double>::infinity();
  /// Degrees of freedom for the true pixel: 1 beside the curve, 2 beyond one of its ends.
  int dof = 1;
  double inverse_depth = 0;
  Eigen::Vector2d direction{1, 0};  ///< tangent of the curve there, unit, towards smaller depths
  Eigen::Matrix2d right_by_left = Eigen::Matrix2d::Identity();  ///< ∂q / ∂p there
};

struct BandOptions {
  double nearest_m = 0.5;  ///< depth at which the curve ends; it begins at infinity
  /// Extra standard deviation of corner positions between views, beyond their covariances.
  double corner_sigma_px = 0.3;
};

/// Search region in the right image for the corner at a left pixel p, from the covariance of the
/// rig. A point at inverse depth ρ projects to
///
///     q(ρ) = project_r(R x + ρ T),   x = unproject_l(p)
///
/// with all derivatives analytic (the left intrinsics through x: δx = −P⁻¹ ∂project_l δa,
/// P = ∂project_l / ∂(x, y)). Its covariance is
///
///     J_a C J_aᵀ + J_p C_p J_pᵀ + σ_c² I
///
/// with C of the rig, C_p of the left corner, and σ_c = `corner_sigma_px`. The distance to the
/// curve is the minimum over ρ of the Mahalanobis distance with the right corner's covariance
/// added: χ² with one degree of freedom beside the curve and two beyond its ends. Rig errors are
/// common to all corners of an image, so the gate's miss rate holds over rigs, not over the corners
/// of one rig.
class EpipolarBand {
 public:
  /// Throws Error unless the rig has two cameras, the covariance has the size of its parameters,
  /// and the options are above 0 (`corner_sigma_px` may be 0).
  EpipolarBand(const Rig& rig, const Eigen::MatrixXd& covariance, const BandOptions& options = {});

  /// The curve of a left corner as a polyline accurate to a tenth of a pixel, clipped to half an
  /// image size around the right image. Empty if the pixel cannot be unprojected.
  std::vector<BandNode> curve(const UncertainPixel& left) const;

 private:
  struct Ray;
  std::optional<BandNode> node(const Ray& ray, double inverse_depth) const;
  BandNode edge(const Ray& ray, BandNode in, double out) const;
  void subdivide(const Ray& ray, const BandNode& to, int depth, std::vector<BandNode>& nodes) const;

  Rig rig_;
  Eigen::MatrixXd covariance_;
  BandOptions options_;
};

/// Distance of a right corner to the curve between nodes i − 1 and i, i > 0.
BandDistance distance_to_step(const std::vector<BandNode>& curve,
                              std::size_t i,
                              const UncertainPixel& right);

/// Minimum distance of a right corner to the whole curve.
BandDistance distance_to_curve(const std::vector<BandNode>& curve, const UncertainPixel& right);

}  // namespace vernier::stereo::internal
