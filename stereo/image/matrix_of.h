// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {

/// A read-only CV_32F view of the image's memory, valid as long as the image.
inline cv::Mat matrix_of(const GreyLevels& image) {
  return {image.height_px, image.width_px, CV_32F, const_cast<float*>(image.values.data())};
}

/// Rounded to 8 bits, after multiplication by a gain.
inline cv::Mat bytes_of(const GreyLevels& image, double gain = 1) {
  cv::Mat bytes;
  matrix_of(image).convertTo(bytes, CV_8U, gain);
  return bytes;
}

}  // namespace vernier::stereo::internal
