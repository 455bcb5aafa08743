// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace vernier::internal {

/// The bytes of an image file. Throws Error for truncated or damaged PNG, JPEG and Netpbm files,
/// whose decoders would fill in the rest or print to standard error. A JPEG file that is intact but
/// that makes a decoder print warnings is returned rewritten, with the same pixels.
std::string read_image_bytes(const std::filesystem::path& file);

/// The decoded pixels, with the flags of cv::imread, as the sensor had them: Exif's orientation
/// does not turn them (but for TIFF, whose decoder turns), since the lens does not turn with it.
/// Throws Error(file) if it is not an image.
cv::Mat decode_image(std::string_view bytes, int flags, const std::filesystem::path& file);

/// The bytes of a PNG file of 8 or 16 bits, with the options of cv::imwrite.
std::string png_of(const cv::Mat& pixels, const std::vector<int>& options = {});

bool is_png(std::string_view bytes);

/// The largest grey value that the header of a PNG (1, 3, 15, 255, 65535) or binary Netpbm file
/// allows; 0 for other formats. OpenCV's decoder scales the first three of PNG to 255, and does not
/// scale Netpbm.
int largest_grey_value(std::string_view bytes);

}  // namespace vernier::internal
