// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/grey_image.h"
#include "calib/base/image_damage.h"
#include "calib/base/image_file.h"
#include "calib/base/jpeg_rewriting.h"
#include "fuzz/fuzz_target.h"
#include "stereo/grey_levels.h"
#include "stereo/image/depth_image.h"

namespace vernier::fuzz {
namespace {

using namespace vernier::internal;

/// Every way in which the program reads an image file.
void run_image(std::string_view bytes, const char* name) {
  const std::filesystem::path file = input_file(bytes, name);
  largest_grey_value(bytes);
  const auto levels = accepted([&] { return stereo::read_grey_levels(file); });
  const auto grey = accepted([&] { return read_grey_image(file); });
  constexpr double millimetre_m = 1e-3;
  const auto depth =
      accepted([&] { return stereo::internal::read_depth_image(file, millimetre_m); });
  if (depth) {
    require(
        std::any_of(depth->depth_m.begin(), depth->depth_m.end(), [](float z) { return z > 0; }) &&
            depth->depth_m.size() == static_cast<std::size_t>(depth->width_px) *
                                         static_cast<std::size_t>(depth->height_px),
        "a depth map has a value for every pixel, and knows some");
  }
  if (grey) require(grey->type() == CV_8U && !grey->empty(), "an image has 8-bit grey values");
  if (!levels) return;
  require(levels->values.size() == static_cast<std::size_t>(levels->width_px) *
                                       static_cast<std::size_t>(levels->height_px),
          "an image has a value for every pixel");
  require(grey.has_value(), "both readers of grey values read the same files");
}

void run_netpbm(std::string_view bytes) { run_image(bytes, "image.pgm"); }

/// As it is: heads, lengths and checksums.
void run_png_head(std::string_view bytes) {
  png_damage(bytes);
  run_image(bytes, "image.png");
}

std::uint32_t crc_of(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFF;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320 : 0);
  }
  return ~crc;
}

/// With the checksums of all chunks put right, so that what is in them is read.
void run_png_chunks(std::string_view bytes) {
  std::string mended(bytes);
  for (std::size_t at = 8; at + 12 <= mended.size();) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      length = length << 8 | static_cast<unsigned char>(mended[at + i]);
    }
    if (length > mended.size() - at - 12) break;
    const std::uint32_t crc = crc_of(std::string_view(mended).substr(at + 4, length + 4));
    for (std::size_t i = 0; i < 4; ++i) {
      mended[at + 8 + length + i] = static_cast<char>(crc >> (24 - 8 * i));
    }
    at += length + 12;
  }
  run_png_head(mended);
}

void run_jpeg(std::string_view bytes) {
  bool warned = false;
  const bool whole = jpeg_damage(bytes, &warned).empty();
  const std::string silent = rewritten_jpeg(bytes);
  if (!silent.empty() && whole) {
    bool warned_again = false;
    require(jpeg_damage(silent, &warned_again).empty() && !warned_again,
            "a rewritten JPEG is whole and makes libjpeg say nothing");
  }
  run_image(bytes, "image.jpg");
}

std::string encoded(const char* ending, int type, const std::vector<int>& options = {}) {
  cv::Mat pixels(11, 17, type);
  cv::theRNG().state = 1;
  cv::randu(pixels, cv::Scalar::all(0), cv::Scalar::all(CV_MAT_DEPTH(type) == CV_8U ? 256 : 65536));
  std::vector<uchar> bytes;
  cv::imencode(ending, pixels, bytes, options);
  return {bytes.begin(), bytes.end()};
}

std::vector<std::string> png_seeds() {
  return {encoded(".png", CV_8UC1), encoded(".png", CV_16UC1), encoded(".png", CV_8UC3),
          encoded(".png", CV_8UC4), encoded(".png", CV_8UC1, {cv::IMWRITE_PNG_BILEVEL, 1})};
}

std::vector<std::string> jpeg_seeds() {
  return {encoded(".jpg", CV_8UC1), encoded(".jpg", CV_8UC3),
          encoded(".jpg", CV_8UC1, {cv::IMWRITE_JPEG_PROGRESSIVE, 1}),
          encoded(".jpg", CV_8UC3, {cv::IMWRITE_JPEG_RST_INTERVAL, 1})};
}

std::vector<std::string> netpbm_seeds() {
  return {encoded(".pgm", CV_8UC1), encoded(".pgm", CV_16UC1), encoded(".ppm", CV_8UC3)};
}

const Registered registered_jpeg{{"jpeg", 4000, "jpeg", run_jpeg, jpeg_seeds}};
const Registered registered_netpbm{{"netpbm", 2000, "netpbm", run_netpbm, netpbm_seeds}};
const Registered registered_png_chunks{{"png_chunks", 2000, "png", run_png_chunks, png_seeds}};
const Registered registered_png_head{{"png_head", 2000, "png", run_png_head, png_seeds}};

}  // namespace
}  // namespace vernier::fuzz
