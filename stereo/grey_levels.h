// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace vernier::stereo {

/// A grey image: levels from 0 to 255, fractions allowed, row-major.
struct GreyLevels {
  int width_px = 0, height_px = 0;
  std::vector<float> values;

  float operator()(int x, int y) const {
    return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) +
                  static_cast<std::size_t>(x)];
  }
};

/// Reads an image file. `remark` is set to the conversion applied to an image that is not 8-bit
/// grey (colour weighted by ITU-R BT.601, higher bit depths scaled by their full range), else to an
/// empty string. Throws Error for a file that is not an image or is truncated.
GreyLevels read_grey_levels(const std::filesystem::path& file, std::string* remark = nullptr);

/// White noise of an image before it was resampled. It moves edges and disparities, while single
/// pixels, whose neighbours err alike, show less of it.
struct SourceNoise {
  double levels = 0;  ///< standard deviation, grey levels; 0: not resampled, as far as is known
  double zoom = 1;    ///< new pixels per pixel along a side, at least 1

  /// White noise of a new pixel with as much power over a patch.
  double per_pixel() const { return levels * zoom; }
};

/// Two images in which corresponding rows show the same epipolar plane.
struct RectifiedPair {
  GreyLevels left, right;
  SourceNoise left_noise = {}, right_noise = {};
};

/// The pair with its images exchanged.
inline RectifiedPair exchanged(const RectifiedPair& pair) {
  return {pair.right, pair.left, pair.right_noise, pair.left_noise};
}

/// Search range of disparities u_left − u_right, both ends included.
struct DisparityRange {
  int min_px = 0, max_px = 64;
};

}  // namespace vernier::stereo
