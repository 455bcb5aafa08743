// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {

/// What of a pair matches outside the range of disparities that is searched.
struct OutsideRange {
  int matched = 0;              ///< edges of the images at half size
  double below = 0, above = 0;  ///< shares of these, by 3 px and more
  DisparityRange wider;         ///< one that holds all but a hundredth of them on either side
};

/// Matches the edges of the pair at half size (edge_matcher.h) over a range that is longer by a
/// half at either end, 32 px at least. An edge whose true disparity lies outside a range is matched
/// to something inside it, and nothing of that match shows it. A scene inside the range has hardly
/// any match outside (eleven Middlebury pairs: at most 0.2 %), unless its texture repeats. All zero
/// for images of less than 64 px.
OutsideRange outside_range(const RectifiedPair& pair, const DisparityRange& range);

}  // namespace vernier::stereo::internal
