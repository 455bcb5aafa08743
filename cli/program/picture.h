// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// Colour map: 0 is blue, 0.5 green, 1 red. Channel order BGR.
cv::Scalar blue_to_red(double share);

/// Encodes a picture as PNG.
std::string png_of(const cv::Mat& picture);

}  // namespace vernier::cli
