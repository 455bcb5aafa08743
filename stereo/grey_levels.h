// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace vernier::stereo {

/// A grey image in memory: grey levels from 0 to 255, row by row, between whole numbers too.
struct GreyLevels {
  int width_px = 0, height_px = 0;
  std::vector<float> values;

  float operator()(int x, int y) const {
    return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) +
                  static_cast<std::size_t>(x)];
  }
};

/// An image file as grey levels. `remark` is set to what was done to an image that is not 8-bit
/// grey (colour weighed by ITU-R BT.601, more bits scaled by their whole range), else empty. Throws
/// Error for what is no image or is cut off.
GreyLevels read_grey_levels(const std::filesystem::path& file, std::string* remark = nullptr);

/// Two images of which every row shows the same epipolar plane.
struct RectifiedPair {
  GreyLevels left, right;
};

/// Disparities u_left − u_right that are searched, both ends included.
struct DisparityRange {
  int min_px = 0, max_px = 64;
};

}  // namespace vernier::stereo
