// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

namespace vernier::stereo::internal {

/// Standard deviation (grey levels) of an image's white noise, estimated from the image: the
/// difference of two Laplacians
///
///     n = I * [1 -2 1; -2 4 -2; 1 -2 1],   var n = 36 σ²
///
/// does not respond to shading and to straight edges along rows and columns (Immerkær, "Fast noise
/// variance estimation", CVIU 64, 1996). To exclude texture, the RMS of n is taken in blocks of 16
/// x 16 pixels and the lower quintile of these is used: up to four fifths of the image may be
/// textured. At least 1/√12, the quantisation noise of integer grey levels. Blocks with values at 0
/// or 255, where noise is clipped, are used only if there are no others.
double image_noise(const cv::Mat& grey);

}  // namespace vernier::stereo::internal
