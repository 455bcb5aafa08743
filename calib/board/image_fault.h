// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace vernier::internal {

/// A measurable fault of a grey image for board detection, with its value; empty if none:
///  - low contrast: the grey values between the 1st and the 99th percentile span less than 40;
///  - over-exposed: more than half of the pixels at 254 or 255; under-exposed: nine tenths below
///  16;
///  - blurred: the steepest edges (99.9th percentile of the gradient) would take more than 9 pixels
///    for the contrast, as behind a Gaussian blur of σ > 3.5 px.
std::string image_fault(const cv::Mat& grey);

}  // namespace vernier::internal
