// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "calib/interval.h"
#include "calib/projection_uncertainty.h"
#include "calib/rig_and_boards.h"
#include "calib/sampler.h"
#include "calib/triangulation.h"
#include "calib/triangulation_uncertainty.h"

namespace vernier::internal {

/// A point of a camera's frame, m, or a direction where it is at infinity.
struct FixedPoint {
  Eigen::Vector3d x_camera;
  bool at_infinity = false;
};

/// Moments of a point's pixel over the draws in which it has one.
struct SampledPixel {
  Eigen::Vector2d mean_shift_px;  ///< mean less the estimate's pixel: what linearity hides
  Eigen::Matrix2d covariance;     ///< px², about the mean
  double non_physical_share = 0;  ///< f or ax not above 0, point behind the camera or in the fold
};

/// The sampled side of calib/projection_uncertainty.h: every draw is projected in full, nothing is
/// linearised. RandomStream of the rig are those of `vernier sample`; where the point is fixed to
/// the boards their poses are drawn given the rig, so `boards` must be there and of the same
/// covariance as the sampler's. One result a point. Throws Error where it is not, or unless
/// samples >= 2.
std::vector<SampledPixel> sampled_projection(const RigSampler& sampler,
                                             const std::optional<RigAndBoards>& boards,
                                             int camera,
                                             PointFixedTo fixed_to,
                                             std::span<const FixedPoint> points,
                                             const SamplingOptions& options = {});

/// Moments of a triangulated point over the draws in which its rays meet in front of the rig.
struct SampledPoint {
  Eigen::Vector3d mean_shift_m;  ///< mean less the estimate's point
  Eigen::Matrix3d covariance;    ///< m², about the mean
  /// 2.5 and 97.5 % of the depth z over all draws; those whose rays part lie beyond every depth, so
  /// an end can be infinite.
  Interval depth_interval_95_m{0, 0};
  double non_physical_share = 0;  ///< draws in which the rays part, or a pixel has no ray
};

/// The sampled side of calib/triangulation_uncertainty.h. The pixels are the pair's, read by each
/// drawn rig, with fresh pixel noise of pair_sigma_px in each draw (0 for the calibration's error
/// alone). Stabilised points go back through the inverse of the boards' drawn mean motion. Throws
/// Error where a pair has no point under the estimate itself.
std::vector<SampledPoint> sampled_triangulation(const RigSampler& sampler,
                                                const std::optional<RigAndBoards>& boards,
                                                TriangulationFrame frame,
                                                std::span<const PixelPair> pairs,
                                                double pair_sigma_px,
                                                const SamplingOptions& options = {},
                                                int other = 1);

/// 2.5 and 97.5 % quantiles of sorted values, linear between neighbours; infinite where one is.
Interval interval_95(const std::vector<double>& sorted);

}  // namespace vernier::internal
