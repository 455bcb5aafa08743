// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>

#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "stereo/grey_levels.h"

namespace vernier::test {

using namespace vernier::stereo;

/// An image of one channel as grey levels.
inline GreyLevels grey_levels(const cv::Mat& image) {
  cv::Mat values;
  image.convertTo(values, CV_32F);
  return {values.cols, values.rows, {values.begin<float>(), values.end<float>()}};
}

/// The grey value at a pixel, beyond the image that of the nearest one.
inline float clamped(const GreyLevels& image, int x, int y) {
  return image(std::clamp(x, 0, image.width_px - 1), std::clamp(y, 0, image.height_px - 1));
}

/// Whole grey levels from 0 to 255, each as likely as any.
inline GreyLevels random_image(int width, int height, std::uint64_t seed) {
  vernier::internal::RandomStream draws(
      {.seed = seed,
       .source = static_cast<std::uint32_t>(vernier::internal::DrawSource::noisy_copy)});
  GreyLevels image{width, height, {}};
  for (int i = 0; i < width * height; ++i) {
    image.values.push_back(static_cast<float>(std::floor(256 * draws.uniform())));
  }
  return image;
}

/// The other way, CV_32F.
inline cv::Mat image_of(const GreyLevels& image) {
  return cv::Mat(image.height_px, image.width_px, CV_32F, const_cast<float*>(image.values.data()))
      .clone();
}

}  // namespace vernier::test
