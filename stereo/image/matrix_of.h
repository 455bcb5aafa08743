// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {

/// The image as a CV_32F matrix of the same memory: to be read only, as long as the image lives.
inline cv::Mat matrix_of(const GreyLevels& image) {
  return {image.height_px, image.width_px, CV_32F, const_cast<float*>(image.values.data())};
}

}  // namespace vernier::stereo::internal
