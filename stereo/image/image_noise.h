// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

namespace vernier::stereo::internal {

/// Standard deviation (grey values) of an image's white noise, from the image itself: the
/// difference of two Laplacians
///
///     n = I * [1 -2 1; -2 4 -2; 1 -2 1],   var n = 36 σ²
///
/// is blind to shading and to straight edges along rows and columns (Immerkær, "Fast noise variance
/// estimation", CVIU 64, 1996). Texture is not noise, so it is the root mean square of n in blocks
/// of 16 x 16 pixels, and of these the lower quintile: four fifths of the image may be textured. At
/// least 1/√12, what rounding to whole grey values leaves. Blocks with values at 0 or 255, where
/// noise is cut off, count only where there are no others.
double image_noise(const cv::Mat& grey);

}  // namespace vernier::stereo::internal
