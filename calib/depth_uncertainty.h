// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "calib/interval.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"

namespace vernier {

/// Uncertainty of the depth of a point on the left optical axis due to the calibration alone (no
/// matching error).
struct DepthUncertainty {
  double range_m = 0;
  double sigma_linear_m = 0;   ///< J C Jᵀ
  double sigma_sampled_m = 0;  ///< over the draws with a positive depth
  double non_physical_share =
      0;  ///< fraction of draws with rays that do not meet in front of the rig
  /// 2.5 and 97.5 % quantiles over all draws. Draws with diverging rays count as infinitely far, so
  /// an end can be infinite.
  Interval interval_95_m{0, 0};
};

/// Depth of the closest approach of the rays of two pixels; not positive if they diverge. Throws
/// Error unless the rig is a pair.
double triangulated_depth_m(const Rig& rig,
                            const Eigen::Vector2d& left_px,
                            const Eigen::Vector2d& right_px);

/// The same; std::nullopt if the rig has no ray for one of the pixels.
std::optional<double> try_triangulated_depth_m(const Rig& rig,
                                               const Eigen::Vector2d& left_px,
                                               const Eigen::Vector2d& right_px);

/// Linear and sampled propagation: pixels are those of the estimate, triangulated with sampled
/// rigs. Depth is not linear in the parameters, so prefer the sampled value if the two differ.
/// Throws Error unless ranges are above 0 and finite, and samples at least 2.
std::vector<DepthUncertainty> depth_uncertainty(const RigEstimate& estimate,
                                                const std::vector<double>& ranges_m,
                                                const SamplingOptions& options = {});

}  // namespace vernier
