// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>

namespace vernier::internal {

/// The bytes of an image file. Throws Error for PNG, JPEG and Netpbm files that are cut off or
/// damaged: their decoders would fill in the rest or print to standard error. A JPEG file that
/// loses no pixels but of which a decoder would print something is given rewritten, with the same
/// pixels.
std::string read_image_bytes(const std::filesystem::path& file);

/// Its pixels, with the flags of cv::imread. Throws Error(file) for what is no image.
cv::Mat decode_image(std::string_view bytes, int flags, const std::filesystem::path& file);

bool is_png(std::string_view bytes);

/// The largest grey value that the header of a PNG (1, 3, 15, 255, 65535) or binary Netpbm file
/// allows; 0 for other formats. The decoder stretches the first three of PNG to 255, and Netpbm's
/// none.
int largest_grey_value(std::string_view bytes);

}  // namespace vernier::internal
