// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {

/// The census transform of an image (Zabih and Woodfill 1994): of each pixel, which of the 62 about
/// it in 9 x 7 are brighter, as bits. Rows have `border` words before and after them that resemble
/// nothing.
struct CensusImage {
  int width = 0, height = 0, border = 0;
  std::vector<std::uint64_t> words;

  const std::uint64_t* row(int y) const {
    return words.data() + static_cast<std::size_t>(y) * stride() + border;
  }
  std::uint64_t* row(int y) {
    return words.data() + static_cast<std::size_t>(y) * stride() + border;
  }
  std::size_t stride() const { return static_cast<std::size_t>(width + 2 * border); }
};

/// Grey levels are rounded to whole ones first; beyond the image's border its outermost pixels are
/// repeated.
CensusImage census_transform(const GreyLevels& image, int border);

/// The same with every row turned round.
CensusImage mirrored(const CensusImage& census);

}  // namespace vernier::stereo::internal
