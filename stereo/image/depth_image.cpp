// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/image/depth_image.h"

#include <algorithm>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "calib/base/image_file.h"
#include "calib/error.h"

namespace vernier::stereo::internal {

using namespace vernier::internal;

DepthImage read_depth_image(const std::filesystem::path& file, double unit_m) {
  if (!(unit_m > 0 && unit_m <= 1)) {
    throw Error("depth image", "the unit of depths is not above 0 and at most 1 m",
                "use 0.001 for millimetres");
  }
  const std::string bytes = read_image_bytes(file);
  const cv::Mat values = decode_image(bytes, cv::IMREAD_UNCHANGED, file);
  if (values.type() != CV_16UC1) {
    throw Error(file.string(), "is no depth map: it has not one channel of 16 bits",
                "give a PNG file of 16 bits with depths");
  }
  DepthImage depth{values.cols, values.rows, {}};
  depth.depth_m.reserve(values.total());
  for (int y = 0; y < values.rows; ++y) {
    const auto* row = values.ptr<std::uint16_t>(y);
    for (int x = 0; x < values.cols; ++x) {
      depth.depth_m.push_back(static_cast<float>(unit_m * row[x]));
    }
  }
  if (std::all_of(depth.depth_m.begin(), depth.depth_m.end(), [](float z) { return z == 0; })) {
    throw Error(file.string(), "no depth is known in it", "leave the image out");
  }
  return depth;
}

}  // namespace vernier::stereo::internal
