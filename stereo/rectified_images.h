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

/// Which pixels of a rectified image have a source: the raw image reaches there.
struct ValidPixels {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> values;  ///< 1 or 0, row by row

  bool operator()(int x, int y) const {
    return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) +
                  static_cast<std::size_t>(x)] != 0;
  }
  double blank_share() const;  ///< of pixels that have none
};

struct RectifiedImages {
  RectifiedPair pair;
  ValidPixels left_valid, right_valid;
};

/// The images of a rig as its rectified cameras would see them. A rectified pixel's ray is turned
/// into its camera and projected there (no lens is inverted), and the raw image read by cubic
/// convolution (Keys 1981, a = −1/2) in full precision: OpenCV's remap rounds places to 1/32 px.
/// Pixels without a source repeat the raw image's border, so that no edge appears there; where not
/// even a place beyond the border is known they are 0. Bits do not depend on the number of threads
/// (0: as many as the machine has). Throws Error where an image is not of its camera's size.
RectifiedImages rectified_images(const Rig& rig,
                                 const RectifiedGeometry& geometry,
                                 const GreyLevels& left,
                                 const GreyLevels& right,
                                 int threads = 1);

}  // namespace vernier::stereo
