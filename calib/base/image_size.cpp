// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/image_size.h"

#include <cstddef>
#include <cstdlib>

#include "calib/base/byte_order.h"

namespace vernier::internal {
namespace {

constexpr std::uint64_t longest_side = std::uint64_t{1} << 20;

template <typename Number>
std::optional<std::uint64_t> whole_at(std::string_view bytes, std::size_t at, bool big_endian) {
  if (at > bytes.size() || bytes.size() - at < sizeof(Number)) return std::nullopt;
  return number_at<Number>(bytes, at, big_endian);
}

std::optional<ImageSize> bmp_size(std::string_view bytes) {
  const auto head = whole_at<std::uint32_t>(bytes, 14, false);
  if (!head) return std::nullopt;
  if (*head == 12) {  // the oldest kind
    const auto width = whole_at<std::uint16_t>(bytes, 18, false);
    const auto height = whole_at<std::uint16_t>(bytes, 20, false);
    return width && height ? std::optional(ImageSize{*width, *height}) : std::nullopt;
  }
  if (bytes.size() < 26) return std::nullopt;
  // A negative height means that the first row is the top one.
  const std::int64_t width = number_at<std::int32_t>(bytes, 18, false);
  const std::int64_t height = number_at<std::int32_t>(bytes, 22, false);
  return ImageSize{static_cast<std::uint64_t>(std::llabs(width)),
                   static_cast<std::uint64_t>(std::llabs(height))};
}

/// The tags of the first directory.
std::optional<ImageSize> tiff_size(std::string_view bytes) {
  constexpr std::uint64_t width_tag = 256, height_tag = 257, of_two_bytes = 3;
  const bool big_endian = bytes[0] == 'M';
  const auto directory = whole_at<std::uint32_t>(bytes, 4, big_endian);
  const auto count =
      directory ? whole_at<std::uint16_t>(bytes, *directory, big_endian) : std::nullopt;
  if (!count) return std::nullopt;
  std::optional<std::uint64_t> width, height;
  for (std::uint64_t i = 0; i < *count; ++i) {
    const std::size_t at = *directory + 2 + 12 * i;
    const auto tag = whole_at<std::uint16_t>(bytes, at, big_endian);
    const auto type = whole_at<std::uint16_t>(bytes, at + 2, big_endian);
    if (!tag || !type) break;
    if (*tag != width_tag && *tag != height_tag) continue;
    (*tag == width_tag ? width : height) = *type == of_two_bytes
                                               ? whole_at<std::uint16_t>(bytes, at + 8, big_endian)
                                               : whole_at<std::uint32_t>(bytes, at + 8, big_endian);
  }
  return width && height ? std::optional(ImageSize{*width, *height}) : std::nullopt;
}

std::optional<ImageSize> webp_size(std::string_view bytes) {
  const std::string_view kind = bytes.substr(12, 4);
  const auto word = [&](std::size_t at) {
    return whole_at<std::uint16_t>(bytes, at, false).value_or(0);
  };
  if (bytes.size() < 30) return std::nullopt;
  // Without these marks OpenCV tries other formats, of which GDCM's ends the process on some files.
  if (kind == "VP8 " && bytes.substr(23, 3) != "\x9d\x01\x2a") return std::nullopt;
  if (kind == "VP8L" && bytes[20] != '\x2f') return std::nullopt;
  if (bytes.size() >= 132 && bytes.substr(128, 4) == "DICM") return std::nullopt;
  if (kind == "VP8 ") return ImageSize{word(26) & 0x3fff, word(28) & 0x3fff};
  if (kind == "VP8L") {  // 14 bits each
    const std::uint64_t bits = word(21) | word(23) << 16;
    return ImageSize{(bits & 0x3fff) + 1, (bits >> 14 & 0x3fff) + 1};
  }
  if (kind != "VP8X") return std::nullopt;
  const auto of_three_bytes = [&](std::size_t at) { return word(at) | (word(at + 1) >> 8) << 16; };
  return ImageSize{of_three_bytes(24) + 1, of_three_bytes(27) + 1};
}

}  // namespace

std::string size_fault(ImageSize size) {
  if (size.width <= longest_side && size.height <= longest_side &&
      size.width * size.height <= most_pixels) {
    return "";
  }
  return "has a header of " + std::to_string(size.width) + "x" + std::to_string(size.height) +
         " pixels, more than can be read (" + std::to_string(most_pixels) + ")";
}

std::optional<ImageSize> bitmap_size(std::string_view bytes) {
  using namespace std::string_view_literals;
  if (bytes.substr(0, 2) == "BM") return bmp_size(bytes);
  if (bytes.substr(0, 4) == "II*\0"sv || bytes.substr(0, 4) == "MM\0*"sv) return tiff_size(bytes);
  if (bytes.substr(0, 4) == "RIFF" && bytes.size() >= 16 && bytes.substr(8, 4) == "WEBP") {
    return webp_size(bytes);
  }
  return std::nullopt;
}

}  // namespace vernier::internal
