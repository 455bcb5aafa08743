// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {

/// What of a pair matches outside the range of disparities that is searched.
struct OutsideRange {
  int edges = 0, matched = 0;  ///< of the images at half size
  int below = 0, above = 0;    ///< of those matched, by 3 px and more
  DisparityRange wider;        ///< one that holds all but a hundredth of them on either side
};

/// Whether a pixel (x, y) inside the image has a source in a raw one (ValidPixels).
using HasSource = std::function<bool(int, int)>;

/// Matches the edges of the pair at half size (edge_matcher.h) over a range that is longer by a
/// half at either end, 32 px at least. An edge whose true disparity lies outside a range is matched
/// to something inside it, and nothing of that match shows it. A scene inside the range has hardly
/// any match outside (eleven Middlebury pairs: at most 0.2 %), unless its texture repeats. Pixels
/// without a source are left out where it is told. All zero for images of less than 64 px.
OutsideRange outside_range(const RectifiedPair& pair,
                           const DisparityRange& range,
                           const HasSource& left_has_source = {},
                           const HasSource& right_has_source = {});

}  // namespace vernier::stereo::internal
