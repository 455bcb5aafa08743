// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

namespace vernier::internal {

/// An image file as 8-bit grey values; deeper ones are scaled from their own largest value. Throws
/// Error for what is no image and for PNG, JPEG and Netpbm files that are cut off or damaged: their
/// decoders would fill in the rest or print to standard error.
cv::Mat read_grey_image(const std::filesystem::path& file);

}  // namespace vernier::internal
