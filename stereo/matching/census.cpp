// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/census.h"
#include "stereo/grey_levels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

// As in calib/solver/view_kernel.cpp.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stereo/matching/census.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a target

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vernier::stereo::internal {
namespace HWY_NAMESPACE {

constexpr int half_width = 4, half_height = 3, block = 256;

/// The bits of up to `block` pixels. `rows` are those from half_height above to half_height below,
/// each with half_width more pixels at both ends; the loops are written for auto-vectorisation.
void census_block(const std::uint8_t* const* rows, int n, std::uint64_t* out) {
  const std::uint8_t* const centre = rows[half_height] + half_width;
  for (int half = 0; half < 2; ++half) {
    std::uint32_t bits[block] = {};
    int k = 0;
    for (int j = 0; j <= 2 * half_height; ++j) {
      for (int i = 0; i <= 2 * half_width; ++i) {
        if (i == half_width && j == half_height) continue;
        if (k++ / 31 != half) continue;
        const std::uint8_t* const there = rows[j] + i;
        for (int x = 0; x < n; ++x) {
          bits[x] = (bits[x] << 1) | static_cast<std::uint32_t>(there[x] > centre[x]);
        }
      }
    }
    for (int x = 0; x < n; ++x) {
      out[x] = half == 0 ? bits[x] : (out[x] << 31) | bits[x];
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::stereo::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::stereo::internal {

HWY_EXPORT(census_block);

namespace {

constexpr std::uint64_t unlike_anything = 0x1555555555555555;

/// Integer grey levels with a replicated border.
struct Padded {
  explicit Padded(const GreyLevels& image)
      : width(image.width_px + 2 * half_width_px),
        values(static_cast<std::size_t>(width) *
               static_cast<std::size_t>(image.height_px + 2 * half_height_px)) {
    std::vector<std::uint8_t> row(static_cast<std::size_t>(width));
    for (int y = -half_height_px; y < image.height_px + half_height_px; ++y) {
      const int from = std::clamp(y, 0, image.height_px - 1);
      const float* const grey = image.values.data() + static_cast<std::size_t>(from) *
                                                          static_cast<std::size_t>(image.width_px);
      std::uint8_t* const to = values.data() + static_cast<std::size_t>(y + half_height_px) *
                                                   static_cast<std::size_t>(width);
      for (int x = 0; x < image.width_px; ++x) {
        to[x + half_width_px] = static_cast<std::uint8_t>(std::clamp(grey[x] + 0.5f, 0.0f, 255.0f));
      }
      for (int x = 0; x < half_width_px; ++x) {
        to[x] = to[half_width_px];
        to[width - 1 - x] = to[width - 1 - half_width_px];
      }
    }
  }
  const std::uint8_t* row(int y) const {
    return values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  }

  static constexpr int half_width_px = 4, half_height_px = 3;
  int width;
  std::vector<std::uint8_t> values;
};

}  // namespace

CensusImage census_transform(const GreyLevels& image, int border) {
  CensusImage census{image.width_px, image.height_px, border, {}};
  census.words.assign(census.stride() * static_cast<std::size_t>(image.height_px), unlike_anything);
  const Padded padded(image);
  constexpr int block = 256;
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < image.width_px; x += block) {
      const std::uint8_t* rows[7];
      for (int j = 0; j < 7; ++j) rows[j] = padded.row(y + j) + x;
      HWY_DYNAMIC_DISPATCH(census_block)
      (rows, std::min(block, image.width_px - x), census.row(y) + x);
    }
  }
  return census;
}

CensusImage mirrored(const CensusImage& census) {
  CensusImage other = census;
  for (int y = 0; y < census.height; ++y) {
    std::reverse(other.row(y), other.row(y) + census.width);
  }
  return other;
}

}  // namespace vernier::stereo::internal
#endif  // HWY_ONCE
