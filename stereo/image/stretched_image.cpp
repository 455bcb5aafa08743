// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/image/stretched_image.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {
namespace {

float between(const float* row, int width, double x) {
  const double inside = std::clamp(x, 0.0, static_cast<double>(width - 1));
  const int left = std::min(static_cast<int>(inside), std::max(0, width - 2));
  const auto t = static_cast<float>(inside - left);
  return (1 - t) * row[left] + t * row[std::min(left + 1, width - 1)];
}

}  // namespace

GreyLevels stretched(const GreyLevels& image, double scale) {
  GreyLevels result{
      static_cast<int>(std::ceil((image.width_px - 1) * scale)) + 1, image.height_px, {}};
  result.values.reserve(static_cast<std::size_t>(result.width_px) *
                        static_cast<std::size_t>(result.height_px));
  const int samples = scale < 1 ? 2 * static_cast<int>(std::ceil(0.5 / scale)) + 1 : 1;
  for (int y = 0; y < image.height_px; ++y) {
    const float* const row = image.values.data() +
                             static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width_px);
    for (int x = 0; x < result.width_px; ++x) {
      float sum = 0;
      for (int i = 0; i < samples; ++i) {
        const double part = (i + 0.5) / samples - 0.5;  // position within the new pixel
        sum += between(row, image.width_px, (x + part) / scale);
      }
      result.values.push_back(sum / static_cast<float>(samples));
    }
  }
  return result;
}

GreyLevels mirrored(const GreyLevels& image) {
  GreyLevels other = image;
  for (int y = 0; y < image.height_px; ++y) {
    const auto row = other.values.begin() + static_cast<std::ptrdiff_t>(y) * image.width_px;
    std::reverse(row, row + image.width_px);
  }
  return other;
}

}  // namespace vernier::stereo::internal
