// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {

/// Reduces to half size, CV_32F: pixel (x, y) is the mean of four and lies at (2x + 0.5, 2y + 0.5).
/// An odd column or row at the end is left out. Grey levels of less than 2 px have no pixel.
cv::Mat half_size(const cv::Mat& image);
GreyLevels half_size(const GreyLevels& image);

}  // namespace vernier::stereo::internal
