// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "calib/interval.h"
#include "calib/statistics/bootstrap.h"
#include "stereo/matcher_evaluation.h"

namespace vernier::stereo::internal {

/// Errors against density of a matcher and of a peer's settings on one scene, densest first
/// (stereo/matcher_evaluation.h).
struct DensityCurves {
  std::vector<CurvePoint> own;
  std::vector<std::vector<CurvePoint>> peer;  ///< one curve for each setting
};

/// How two matchers' shares of errors above 1 px compare where both leave out as much.
struct EqualDensity {
  std::size_t setting = 0;  ///< of the peer: the one that compares best
  double density = 0;       ///< mean over scenes
  double own_bad_1 = 0, peer_bad_1 = 0;
  double ratio = 0;   ///< of the means, own over the peer's; infinite where the peer's alone is 0
  Interval interval;  ///< of the ratio, scenes resampled, the best setting chosen anew; its upper
                      ///< end may be infinite
};

/// On each scene the density is the largest that both reach. Throws Error without scenes, or where
/// they have different numbers of settings, or a curve is empty.
EqualDensity at_equal_density(const std::vector<DensityCurves>& scenes,
                              const vernier::internal::BootstrapOptions& options = {});

}  // namespace vernier::stereo::internal
