// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/grey_levels.h"

#include <fmt/core.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <string_view>

#include "calib/base/image_file.h"
#include "calib/error.h"

namespace vernier::stereo {

using namespace vernier::internal;

namespace {

/// Factor that maps the file's range to 0 to 255.
double scale_of(const cv::Mat& pixels, std::string_view bytes) {
  const int stated = is_png(bytes) ? 0 : largest_grey_value(bytes);
  if (stated > 0) return 255.0 / stated;
  return pixels.depth() == CV_8U ? 1 : 1.0 / 257;
}

/// Describes the conversion, and whether the image uses hardly any of its range.
std::string remark_on(const cv::Mat& pixels, double scale) {
  const bool is_colour = pixels.channels() > 1, is_deep = pixels.depth() == CV_16U;
  if (!is_colour && !is_deep && scale == 1) return "";
  std::string remark = is_deep ? "16-bit " : "";
  remark += is_colour ? "colour image, converted to grey" : "image";
  if (scale < 1) remark += fmt::format(", scaled by 1/{:.6g}", 1 / scale);
  if (scale > 1) remark += fmt::format(", scaled by {:.6g}", scale);
  double largest = 0;
  cv::minMaxLoc(pixels.reshape(1), nullptr, &largest);
  if (is_deep && largest * scale < 32) {
    remark += fmt::format("; its largest value is only {:.0f}", largest);
  }
  return remark;
}

}  // namespace

GreyLevels read_grey_levels(const std::filesystem::path& file, std::string* remark) {
  const std::string bytes = read_image_bytes(file);
  const cv::Mat pixels = decode_image(bytes, cv::IMREAD_ANYCOLOR | cv::IMREAD_ANYDEPTH, file);
  if (pixels.depth() != CV_8U && pixels.depth() != CV_16U) {
    throw Error(file.string(), "the pixels are neither unsigned 8-bit nor unsigned 16-bit",
                "save it as an 8- or 16-bit image");
  }
  const double scale = scale_of(pixels, bytes);
  if (remark) *remark = remark_on(pixels, scale);
  GreyLevels grey{pixels.cols, pixels.rows, std::vector<float>(pixels.total())};
  cv::Mat levels(pixels.size(), CV_32F, grey.values.data());
  cv::Mat weighed;
  pixels.convertTo(weighed, CV_32F);
  if (pixels.channels() > 1) cv::cvtColor(weighed, weighed, cv::COLOR_BGR2GRAY);
  weighed.convertTo(levels, CV_32F, scale);
  return grey;
}

}  // namespace vernier::stereo
