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

/// A point of a camera's frame, m, or a direction if it is at infinity.
struct FixedPoint {
  Eigen::Vector3d x_camera;
  bool at_infinity = false;
};

/// Moments of a point's pixel over the draws with a valid projection.
struct SampledPixel {
  Eigen::Vector2d mean_shift_px;  ///< mean minus the estimate's pixel, zero in a linear model
  Eigen::Matrix2d covariance;     ///< px², about the mean
  double non_physical_share =
      0;  ///< fraction with f or ax not above 0, point behind the camera or beyond the fold
};

/// The sampled counterpart of calib/projection_uncertainty.h: every draw is projected without
/// linearisation. The random streams of the rig are those of `vernier sample`; if the point is
/// fixed to the boards, their poses are drawn given the rig, so `boards` must be given and have the
/// same covariance as the sampler. One result per point. Throws Error if it is not, or unless
/// samples >= 2.
std::vector<SampledPixel> sampled_projection(const RigSampler& sampler,
                                             const std::optional<RigAndBoards>& boards,
                                             int camera,
                                             PointFixedTo fixed_to,
                                             std::span<const FixedPoint> points,
                                             const SamplingOptions& options = {});

/// Moments of a triangulated point over the draws whose rays meet in front of the rig.
struct SampledPoint {
  Eigen::Vector3d mean_shift_m;  ///< mean minus the estimate's point
  Eigen::Matrix3d covariance;    ///< m², about the mean
  /// 2.5 and 97.5 % quantiles of the depth z over all draws. Draws with diverging rays count as
  /// infinitely far, so an end can be infinite.
  Interval depth_interval_95_m{0, 0};
  double non_physical_share = 0;  ///< fraction with diverging rays, or a pixel without a ray
};

/// The sampled counterpart of calib/triangulation_uncertainty.h. The pixels are the pair's,
/// triangulated with each drawn rig, with new pixel noise of pair_sigma_px in each draw (0 for the
/// calibration's error alone). Stabilised points are mapped by the inverse of the boards' drawn
/// mean motion. Throws Error if a pair cannot be triangulated with the estimate itself.
std::vector<SampledPoint> sampled_triangulation(const RigSampler& sampler,
                                                const std::optional<RigAndBoards>& boards,
                                                TriangulationFrame frame,
                                                std::span<const PixelPair> pairs,
                                                double pair_sigma_px,
                                                const SamplingOptions& options = {},
                                                int other = 1);

/// 2.5 and 97.5 % quantiles of sorted values, linear between neighbours; infinite if one is.
Interval interval_95(const std::vector<double>& sorted);

}  // namespace vernier::internal
