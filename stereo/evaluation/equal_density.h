// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "calib/interval.h"
#include "calib/statistics/bootstrap.h"
#include "stereo/matcher_evaluation.h"

namespace vernier::stereo::internal {

/// Error–density curves of a matcher and of a peer's settings on one scene, densest first
/// (stereo/matcher_evaluation.h).
struct DensityCurves {
  std::vector<CurvePoint> own;
  std::vector<std::vector<CurvePoint>> peer;  ///< one curve per setting
};

/// Fractions of errors above 1 px of two matchers at the same density.
struct EqualDensity {
  std::size_t setting = 0;  ///< index of the peer's best setting
  double density = 0;       ///< mean over scenes
  double own_bad_1 = 0, peer_bad_1 = 0;
  double ratio = 0;  ///< mean of own over mean of peer; infinite if only the peer's is 0
  /// 95 %, of the logarithm; scenes are resampled and the best setting chosen anew; the lower end
  /// may be 0 and the upper one infinite. NaN for fewer than three scenes, or a ratio of 0 or
  /// infinity.
  Interval interval;
};

/// On each scene the density is the largest that both reach. Throws Error for no scenes, unequal
/// numbers of settings, and empty curves.
EqualDensity at_equal_density(const std::vector<DensityCurves>& scenes,
                              const vernier::internal::BootstrapOptions& options = {});

}  // namespace vernier::stereo::internal
