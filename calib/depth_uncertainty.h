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

/// How well a pair knows the depth of a point on the left optical axis, as far as its calibration
/// decides (no matching error).
struct DepthUncertainty {
  double range_m = 0;
  double sigma_linear_m = 0;      ///< J C Jᵀ
  double sigma_sampled_m = 0;     ///< over the draws with a positive depth
  double non_physical_share = 0;  ///< draws in which the rays do not meet in front of the rig
  /// 2.5 and 97.5 % over all draws; those in which the rays part count as beyond every depth, so an
  /// end can be infinite.
  Interval interval_95_m{0, 0};
};

/// Depth where the rays of two pixels pass nearest each other under a rig; not positive where they
/// part. Throws Error unless the rig is a pair.
double triangulated_depth_m(const Rig& rig,
                            const Eigen::Vector2d& left_px,
                            const Eigen::Vector2d& right_px);

/// The same, or nothing where the rig has no ray for one of the pixels.
std::optional<double> try_triangulated_depth_m(const Rig& rig,
                                               const Eigen::Vector2d& left_px,
                                               const Eigen::Vector2d& right_px);

/// Linear and sampled, side by side: the pixels are those of the estimate, the rig that reads them
/// is drawn. Depth is not linear in the parameters, so trust the sampled one where they part.
/// Throws Error unless ranges are above 0 and finite, and samples at least 2.
std::vector<DepthUncertainty> depth_uncertainty(const RigEstimate& estimate,
                                                const std::vector<double>& ranges_m,
                                                const SamplingOptions& options = {});

}  // namespace vernier
