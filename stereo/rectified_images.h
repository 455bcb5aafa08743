// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/rig.h"
#include "stereo/grey_levels.h"
#include "stereo/rectification.h"

namespace vernier::stereo {

/// Mask of the pixels of a rectified image that have a source in the raw image.
struct ValidPixels {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> values;  ///< 1 or 0, row-major

  bool operator()(int x, int y) const {
    return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) +
                  static_cast<std::size_t>(x)] != 0;
  }
  double blank_share() const;  ///< fraction of pixels without a source
};

struct RectifiedImages {
  RectifiedPair pair;
  ValidPixels left_valid, right_valid;
};

/// Rectifies the images of a rig. A rectified pixel's ray is rotated to its camera and projected
/// there (the lens distortion is not inverted), and the raw image is interpolated by cubic
/// convolution (Keys 1981, a = −1/2) at full precision; OpenCV's remap rounds positions to 1/32 px.
/// Pixels without a source replicate the raw image's border, so that no edge appears there, and are
/// 0 where not even a position beyond the border is defined. Results do not depend on the number of
/// threads (0: all cores). Throws Error if an image does not have the size of its camera.
RectifiedImages rectified_images(const Rig& rig,
                                 const RectifiedGeometry& geometry,
                                 const GreyLevels& left,
                                 const GreyLevels& right,
                                 int threads = 1);

}  // namespace vernier::stereo
