// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

namespace vernier::stereo::internal {

/// A depth map: the distance along the optical axis at each pixel of an image.
struct DepthImage {
  int width_px = 0, height_px = 0;
  std::vector<float> depth_m;  ///< row-major; 0: unknown

  float operator()(int x, int y) const {
    return depth_m[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) +
                   static_cast<std::size_t>(x)];
  }
};

/// Reads a PNG file of 16 bits whose values are depths in units of unit_m, 0 where unknown, as
/// TUM's RGB-D data, ScanNet and 7-Scenes have them (their units: 0.0002, 0.001, 0.001 m). Throws
/// Error(file) for images of another kind, and where no depth is known.
DepthImage read_depth_image(const std::filesystem::path& file, double unit_m = 0.001);

}  // namespace vernier::stereo::internal
