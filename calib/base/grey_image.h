// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

namespace vernier::internal {

/// Reads an image file as 8-bit grey values; deeper images are scaled by their own maximum. Throws
/// Error for files that are not images, and for truncated or damaged PNG, JPEG and Netpbm files,
/// whose decoders would fill in the rest or print to standard error.
cv::Mat read_grey_image(const std::filesystem::path& file);

}  // namespace vernier::internal
