// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/image/resampled_image.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "calib/base/ordered_parallel.h"
#include "stereo/grey_levels.h"
#include "stereo/image/matrix_of.h"
#include "stereo/image/patch_alignment.h"

namespace vernier::stereo::internal {

using namespace vernier::internal;

GreyLevels resampled(const GreyLevels& image,
                     const Eigen::Vector2i& size_px,
                     const PixelSource& source,
                     int threads) {
  const auto width = static_cast<std::size_t>(size_px[0]);
  GreyLevels result{size_px[0], size_px[1],
                    std::vector<float>(width * static_cast<std::size_t>(size_px[1]))};
  const cv::Mat values = matrix_of(image);
  for_each_index(static_cast<std::size_t>(size_px[1]), threads, [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      const auto at = source(static_cast<int>(x), static_cast<int>(y));
      if (!at) continue;
      const double u = std::clamp(at->x(), 0.0, image.width_px - 1.0);
      const double v = std::clamp(at->y(), 0.0, image.height_px - 1.0);
      result.values[y * width + x] =
          static_cast<float>(std::clamp(grey_between(values, u, v), 0.0, 255.0));
    }
  });
  return result;
}

}  // namespace vernier::stereo::internal
