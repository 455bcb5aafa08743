// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {

/// Census transform of an image (Zabih and Woodfill 1994): for each pixel, one bit for each of the
/// 62 others in 9 x 7 that tells whether it is brighter. Rows are padded with `border` words on
/// both sides that match nothing.
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

/// Grey levels are rounded to integers first; the image border is replicated.
CensusImage census_transform(const GreyLevels& image, int border);

/// The transform mirrored along its rows.
CensusImage mirrored(const CensusImage& census);

}  // namespace vernier::stereo::internal
