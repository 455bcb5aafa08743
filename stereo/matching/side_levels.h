// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {

/// Grey levels of an image, means of 3 x 3 pixels rounded to integers. Rows are padded with
/// `border` copies of their ends on both sides.
struct LevelImage {
  int width = 0, height = 0, border = 0;
  std::vector<std::uint8_t> values;

  const std::uint8_t* row(int y) const {
    return values.data() + static_cast<std::size_t>(y) * stride() + border;
  }
  std::uint8_t* row(int y) {
    return values.data() + static_cast<std::size_t>(y) * stride() + border;
  }
  std::size_t stride() const { return static_cast<std::size_t>(width + 2 * border); }
};

/// The image border is replicated.
LevelImage mean_levels(const GreyLevels& image, int border);

/// Mirrored along its rows.
LevelImage mirrored(const LevelImage& levels);

/// Where the brighter side of an edge point is seen, whole pixels in x and y from it; the darker
/// one is opposite. At most 2 px each, whatever the normal.
using SideOffset = std::array<int, 2>;
SideOffset side_offset(const Eigen::Vector2f& normal);

/// Padding that side offsets need beyond that of a census.
inline constexpr int side_border = 3;

/// Grey levels on both sides of points, of their own image and of the other one. The other's are in
/// the tones of the own (tone_curve.h).
struct SideLevels {
  const LevelImage &own, &other;
  const std::vector<SideOffset>& offsets;  ///< one a point, in the own image
  int tolerance = 0;                       ///< up to this, a difference of two levels is none
};

}  // namespace vernier::stereo::internal
