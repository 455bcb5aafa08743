// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/image_file.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstddef>
#include <new>
#include <optional>
#include <string>
#include <string_view>

#include "calib/base/atomic_file.h"
#include "calib/base/image_codecs.h"
#include "calib/base/image_damage.h"
#include "calib/base/image_size.h"
#include "calib/base/jpeg_rewriting.h"
#include "calib/base/png_rewriting.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

constexpr std::string_view png_signature{"\x89PNG\r\n\x1a\n", 8};

// These signatures are as strict as those of OpenCV's decoders: bytes that no other one takes go to
// GDCM and GDAL there, which read many more formats and end the process on some.
bool is_netpbm(std::string_view bytes, char first_kind, char last_kind) {
  return bytes.size() > 2 && bytes[0] == 'P' && bytes[1] >= first_kind && bytes[1] <= last_kind &&
         std::isspace(static_cast<unsigned char>(bytes[2]));
}

bool is_netpbm(std::string_view bytes) { return is_netpbm(bytes, '5', '6'); }

/// As text, or of bits.
bool is_rare_netpbm(std::string_view bytes) { return is_netpbm(bytes, '1', '4'); }

bool is_jpeg(std::string_view bytes) { return bytes.substr(0, 3) == "\xff\xd8\xff"; }

constexpr const char* no_image = "is not an image that can be read";

/// The header of a Netpbm file.
struct NetpbmHead {
  std::size_t width = 0, height = 0, largest = 0;
  std::size_t end = 0;  ///< of the header; 0 if it is invalid
};

NetpbmHead netpbm_head(std::string_view bytes) {
  NetpbmHead head;
  std::size_t at = 2;
  for (std::size_t* value : {&head.width, &head.height, &head.largest}) {
    if (value == &head.largest && (bytes[1] == '1' || bytes[1] == '4')) break;
    while (at < bytes.size() &&
           (std::isspace(static_cast<unsigned char>(bytes[at])) || bytes[at] == '#')) {
      at = bytes[at] == '#' ? std::min(bytes.find('\n', at), bytes.size()) : at + 1;
    }
    const auto parsed = std::from_chars(bytes.data() + at, bytes.data() + bytes.size(), *value);
    if (parsed.ec != std::errc()) return head;
    at = static_cast<std::size_t>(parsed.ptr - bytes.data());
  }
  head.end = at;
  return head;
}

/// The fault of a binary Netpbm file that has fewer pixels than its header declares; empty if none.
std::string netpbm_fault(std::string_view bytes) {
  const NetpbmHead head = netpbm_head(bytes);
  if (head.end == 0) return "has an invalid Netpbm header";
  const std::string fault = size_fault({head.width, head.height});
  if (!fault.empty() || is_rare_netpbm(bytes)) return fault;
  const std::size_t pixel = (bytes[1] == '6' ? 3 : 1) * (head.largest > 255 ? 2 : 1);
  const bool whole = bytes.size() >= head.end + 1 + head.width * head.height * pixel;
  return whole ? "" : "is cut off (it has fewer pixels than its header says)";
}

/// `warned`: another decoder would print something nevertheless.
std::string fault_of(std::string_view bytes, bool& warned) {
  if (is_netpbm(bytes) || is_rare_netpbm(bytes)) return netpbm_fault(bytes);
  if (is_png(bytes)) return png_damage(bytes, &warned);
  if (is_jpeg(bytes)) return jpeg_damage(bytes, &warned);
  const std::optional<ImageSize> size = bitmap_size(bytes);
  return size ? size_fault(*size) : no_image;
}

}  // namespace

std::string read_image_bytes(const std::filesystem::path& file) {
  std::string bytes = read_whole(file);
  bool warned = false;
  const std::string fault = fault_of(bytes, warned);
  if (!fault.empty()) {
    throw Error(file.string(), fault,
                fault == no_image ? "check the file" : "copy it again, or leave it out");
  }
  if (warned) {
    std::string silent = is_png(bytes) ? rewritten_png(bytes) : rewritten_jpeg(bytes);
    if (!silent.empty()) return silent;
  }
  return bytes;
}

cv::Mat decode_image(std::string_view bytes, int flags, const std::filesystem::path& file) {
  flags |= cv::IMREAD_IGNORE_ORIENTATION;  // the lens belongs to the sensor's pixels
  cv::Mat pixels;
  if (!bytes.empty()) {
    const cv::Mat buffer(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data()));
    try {
      pixels = decode_by_imgcodecs(buffer, flags);
    } catch (const cv::Exception& fault) {  // others are reported below
      if (fault.code == cv::Error::StsNoMem) throw std::bad_alloc();
    }
  }
  if (pixels.empty()) {
    throw Error(file.string(), no_image, "check the file");
  }
  return pixels;
}

std::string png_of(const cv::Mat& pixels, const std::vector<int>& options) {
  std::vector<unsigned char> bytes;
  encode_by_imgcodecs(".png", pixels, bytes, options);
  return {bytes.begin(), bytes.end()};
}

bool is_png(std::string_view bytes) { return bytes.substr(0, 8) == png_signature; }

int largest_grey_value(std::string_view bytes) {
  constexpr std::size_t depth_at = 24;             // in the header chunk, which comes first
  if (is_png(bytes) && bytes.size() > depth_at) {  // a PNG has at most 16 bits, whatever this says
    return (1 << std::clamp<int>(bytes[depth_at], 0, 16)) - 1;
  }
  if (is_netpbm(bytes))
    return static_cast<int>(std::min<std::size_t>(netpbm_head(bytes).largest, 65535));
  return 0;
}

}  // namespace vernier::internal
