// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace vernier::internal {

/// Width and height of an image in pixels, as its header says.
struct ImageSize {
  std::uint64_t width = 0, height = 0;
};

/// Of 2^27 pixels, above 11,585 x 11,585: more than a camera has, and as much as a pair of images
/// can have in 2 GB of memory.
inline constexpr std::uint64_t most_pixels = std::uint64_t{1} << 27;

/// "has a header of …" for more pixels than can be read or a side above 2^20, otherwise empty.
std::string size_fault(ImageSize size);

/// The size in the header of a BMP, TIFF or WebP file, without decoding: of a TIFF file's first
/// image. Nothing for other formats, and for a header without a size.
std::optional<ImageSize> bitmap_size(std::string_view bytes);

}  // namespace vernier::internal
