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

/// Where the right camera may see what is at a left pixel: a point at inverse depth ρ on the curve
struct BandNode {
  double inverse_depth = 0;  ///< 1 / z in the left camera's frame, 1 / m
  Eigen::Vector2d pixel_px;  ///< q(ρ), in the right image as it is, distorted
  Eigen::Matrix2d covariance_px2 = Eigen::Matrix2d::Zero();  ///< of q(ρ)
  bool follows = false;  ///< the curve runs here from the node before
};

/// How near a right pixel is to the curve.
struct BandDistance {
  double mahalanobis2 = std::numeric_limits<double>::infinity();
  int dof =
      1;  ///< of mahalanobis2 for the true pixel: 1 beside the curve, 2 beyond one of its ends
  double inverse_depth = 0;
  Eigen::Vector2d direction{1, 0};  ///< of the curve there, unit, towards nearer points
};

struct BandOptions {
  double nearest_m = 0.5;        ///< depth at which the curve ends; it begins at infinity
  double corner_sigma_px = 0.3;  ///< by which corners of one thing differ beyond their covariances
};

/// The part of the right image in which the corner at a left pixel p has to be, by how well the rig
/// is known. At inverse depth ρ the right camera sees it at
///
///     q(ρ) = project_r(R x + ρ T),   x = unproject_l(p)
///
/// and with all derivatives taken exactly (the left intrinsics through x: δx = −P⁻¹ ∂project_l δa,
/// P = ∂project_l / ∂(x, y)) its covariance is
///
///     J_a C J_aᵀ + J_p C_p J_pᵀ + σ_c² I
///
/// of the rig's C, the left corner's C_p and σ_c, `corner_sigma_px`. The distance to the curve is
/// the least over ρ of Mahalanobis' with the right corner's covariance added: χ² of one degree of
/// freedom beside the curve, of two beyond its ends. Errors of the rig are common to all corners of
/// an image, so the rate at which the truth lies outside a gate holds over rigs, not over the
/// corners of one.
class EpipolarBand {
 public:
  /// Throws Error unless the rig is a pair, the covariance is of its parameters and the options are
  /// above 0 (the corners' sigma may be 0).
  EpipolarBand(const Rig& rig, const Eigen::MatrixXd& covariance, const BandOptions& options = {});

  /// The curve of a left corner, in steps straight to a tenth of a pixel, as far as it is within
  /// half an image's size of the right image. Empty where the pixel has no ray.
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

/// Distance of a right corner to the curve between node i − 1 and node i, i > 0.
BandDistance distance_to_step(const std::vector<BandNode>& curve,
                              std::size_t i,
                              const UncertainPixel& right);

/// To the whole curve: the least.
BandDistance distance_to_curve(const std::vector<BandNode>& curve, const UncertainPixel& right);

}  // namespace vernier::stereo::internal
