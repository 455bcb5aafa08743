// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/disparity_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "calib/base/atomic_file.h"
#include "calib/base/byte_order.h"
#include "calib/base/image_file.h"
#include "calib/base/image_size.h"
#include "calib/base/numpy_array.h"
#include "calib/base/text_lines.h"
#include "calib/error.h"

namespace vernier::stereo {

using namespace vernier::internal;

namespace {

constexpr double png_scale = 256;  // of written files

/// A map as stored in its file.
struct StoredMap {
  int width = 0, height = 0;
  bool of_whole_numbers = false;
  std::vector<double> values;  ///< row-major from the top
};

/// The next token of a PFM header.
std::string_view next_word(std::string_view bytes, std::size_t& at, const std::string& place) {
  const std::string_view blanks(" \t\r\n");
  const std::size_t begin = bytes.find_first_not_of(blanks, at);
  const std::size_t end =
      begin == std::string_view::npos ? begin : bytes.find_first_of(blanks, begin);
  if (end == std::string_view::npos || end - begin > 32) {
    throw Error(place, "is truncated or damaged in its PFM header", "write it again");
  }
  at = end;
  return bytes.substr(begin, end - begin);
}

StoredMap parse_pfm(std::string_view bytes, const std::string& place) {
  std::size_t at = 2;
  StoredMap map;
  map.width = parse_whole(next_word(bytes, at, place), place, "a width");
  map.height = parse_whole(next_word(bytes, at, place), place, "a height");
  const double scale = parse_real(next_word(bytes, at, place), place, "a scale");
  constexpr int max_side = 1 << 20;
  if (map.width < 1 || map.height < 1 || map.width > max_side || map.height > max_side) {
    throw Error(place, fmt::format("has the size {} x {}", map.width, map.height),
                "use a map of an image");
  }
  const ImageSize size{static_cast<std::uint64_t>(map.width),
                       static_cast<std::uint64_t>(map.height)};
  if (const std::string fault = size_fault(size); !fault.empty()) {
    throw Error(place, fault, "use a map of an image");
  }
  if (!std::isfinite(scale) || scale == 0) {
    throw Error(place, "the PFM scale is 0 or not finite",
                "use -1 for little-endian and 1 for big-endian values");
  }
  at += bytes.substr(at, 2) == "\r\n" ? 2 : 1;
  const auto width = static_cast<std::size_t>(map.width);
  const auto height = static_cast<std::size_t>(map.height);
  const std::size_t wanted = 4 * width * height;
  if (bytes.size() - at != wanted) {
    throw Error(place,
                fmt::format("has {} bytes of values, {} than the {} for {} x {}", bytes.size() - at,
                            bytes.size() - at < wanted ? "fewer" : "more", wanted, width, height),
                "write it again");
  }
  map.values.resize(width * height);
  for (std::size_t y = 0; y < height; ++y) {
    double* row = &map.values[(height - 1 - y) * width];
    for (std::size_t x = 0; x < width; ++x, at += 4)
      row[x] = number_at<float>(bytes, at, scale > 0);
  }
  return map;
}

/// The only channel, or one of three equal ones.
cv::Mat one_channel(const cv::Mat& pixels, const std::string& place) {
  cv::Mat first;
  cv::extractChannel(pixels, first, 0);
  for (int i = 1; i < pixels.channels(); ++i) {
    cv::Mat other;
    cv::extractChannel(pixels, other, i);
    if (pixels.channels() != 3 || cv::norm(first, other, cv::NORM_INF) != 0) {
      throw Error(
          place, pixels.channels() == 3 ? "is a colour image" : "is an image with an alpha channel",
          "use a single-channel image");
    }
  }
  return first;
}

StoredMap parse_image(const std::string& bytes, const std::filesystem::path& file) {
  const int largest = largest_grey_value(bytes);
  if (is_png(bytes) && largest < 255) {
    throw Error(file.string(), "has fewer than 8 bits per pixel", "save it with 8 or 16 bits");
  }
  const cv::Mat grey = one_channel(decode_image(bytes, cv::IMREAD_UNCHANGED, file), file.string());
  StoredMap map{grey.cols, grey.rows, true, {}};
  cv::Mat values;
  grey.convertTo(values, CV_64F);
  map.values.assign(values.begin<double>(), values.end<double>());
  return map;
}

StoredMap parse_map(const std::filesystem::path& file) {
  const std::string bytes = read_whole(file);
  const std::string place = file.string(), start = bytes.substr(0, 2);
  if (start == "Pf") return parse_pfm(bytes, place);
  if (start == "PF") throw Error(place, "is a PFM of 3 channels", "use one channel (Pf)");
  if (is_numpy(bytes)) {
    NumpyArray array = parse_numpy(bytes, place);
    return {static_cast<int>(array.columns), static_cast<int>(array.rows), array.of_whole_numbers,
            std::move(array.values)};
  }
  if (start == "PK") {
    throw Error(place, ".npz archives are not supported", "save the array as .npy with numpy.save");
  }
  if (is_png(bytes) || start == "P5") return parse_image(read_image_bytes(file), file);
  throw Error(place, bytes.empty() ? "is empty" : "is neither PFM, PNG, PGM nor .npy",
              "use one of these formats");
}

void check_size(const DisparityMap& map, const std::string& place) {
  if (map.width_px < 1 || map.height_px < 1 ||
      map.values.size() != static_cast<std::size_t>(map.width_px) * map.height_px) {
    throw Error(place, "the number of values does not match the map's size",
                "give width x height values");
  }
}

std::string png_bytes(const DisparityMap& map, const std::string& place) {
  cv::Mat pixels(map.height_px, map.width_px, CV_16U, cv::Scalar(0));
  for (int y = 0; y < map.height_px; ++y) {
    for (int x = 0; x < map.width_px; ++x) {
      if (!map.known(x, y)) continue;
      const double value = std::round(png_scale * map(x, y));
      if (map(x, y) < 0 || value > 65535) {
        throw Error(place, fmt::format("cannot store a disparity of {} px as PNG", map(x, y)),
                    "use .pfm or .npy");
      }
      pixels.at<ushort>(y, x) = static_cast<ushort>(std::max(value, 1.0));
    }
  }
  return internal::png_of(pixels);
}

}  // namespace

DisparityMap read_disparity(const std::filesystem::path& file,
                            const DisparityFileOptions& options) {
  if (!(options.scale > 0) || !std::isfinite(options.scale)) {
    throw Error("scale of " + file.string(), "is not a positive number",
                "give file values per pixel");
  }
  const StoredMap stored = parse_map(file);
  const bool zero_is_unknown = options.zero_is_unknown.value_or(stored.of_whole_numbers);
  DisparityMap map{stored.width, stored.height, {}};
  map.values.reserve(stored.values.size());
  for (const double value : stored.values) {
    const double disparity = value / options.scale;
    const bool known = std::abs(disparity) <= std::numeric_limits<float>::max() &&
                       disparity >= options.min_px && value != options.unknown &&
                       !(zero_is_unknown && value == 0);
    map.values.push_back(known ? static_cast<float>(disparity)
                               : std::numeric_limits<float>::quiet_NaN());
  }
  return map;
}

std::string disparity_pfm(const DisparityMap& map) {
  check_size(map, "disparity map");
  std::string bytes = fmt::format("Pf\n{} {}\n-1\n", map.width_px, map.height_px);
  for (int y = map.height_px - 1; y >= 0; --y) {
    for (int x = 0; x < map.width_px; ++x) {
      append_number(bytes, map.known(x, y) ? map(x, y) : std::numeric_limits<float>::infinity(),
                    false);
    }
  }
  return bytes;
}

void write_disparity(const std::filesystem::path& file, const DisparityMap& map) {
  const std::string kind = file.extension().string(), place = file.string();
  check_size(map, place);
  if (kind == ".pfm") {
    write_atomically(file, disparity_pfm(map));
  } else if (kind == ".npy") {
    write_atomically(file, numpy_bytes(map.values, map.height_px, map.width_px));
  } else if (kind == ".png") {
    write_atomically(file, png_bytes(map, place));
  } else {
    throw Error(place, "unknown file extension", "use .pfm, .png or .npy");
  }
}

}  // namespace vernier::stereo
