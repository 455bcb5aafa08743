// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "sim/sequence/sequence_samples.h"
#include "sim/sources/measured_sources.h"

namespace vernier::sim::internal {

/// Of lines that are expected in two views so far apart, and that one of them loses whole: how many
/// the other loses too. Were losses independent, this would be the share of lines that are lost.
struct LostAgain {
  double from_m = 0, to_m = 0;  ///< between the camera's centres, to_m excluded
  MeasuredValue again;          ///< share; NaN with fewer than 30 pairs; not corrected for chance
};

/// What the source `missed` takes from the losses of views near each other: their correlation at
/// one place, c, and the side s of places that lose alike. Of two views d < s apart the lines of a
/// share o(d) = 1 - 4 d / (pi s) + (d / s)^2 / pi of grids in any direction lie in one cell, and
/// their losses have the correlation c o(d). A constant h beside it is what lines differ by: some
/// are lost more often than others wherever one stands, which the source does not know.
struct LossesAlike {
  MeasuredValue correlation, side_m;
};

/// Least squares of h + c o(d) over pairs of views up to 2 m apart, in steps of 0.1 m, weighted by
/// the number of lines that the first of them lost; sides up to 1.5 m.
LossesAlike losses_alike(const std::vector<ExpectedSample>& expected,
                         std::span<const SequenceView> views,
                         const std::vector<int>& block,
                         const MeasuringOptions& options);

/// For views up to 0.25, 0.5, 1, 2 and 4 m apart and beyond. Intervals by a bootstrap over `block`,
/// which has one number a view.
std::vector<LostAgain> lost_again(const std::vector<ExpectedSample>& expected,
                                  std::span<const SequenceView> views,
                                  const std::vector<int>& block,
                                  const MeasuringOptions& options);

}  // namespace vernier::sim::internal
