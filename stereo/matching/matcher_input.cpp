// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/matcher_input.h"

#include <fmt/core.h>

#include <cstddef>

#include "calib/error.h"
#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {
namespace {

bool is_whole(const GreyLevels& image) {
  return image.width_px > 0 && image.height_px > 0 &&
         image.values.size() ==
             static_cast<std::size_t>(image.width_px) * static_cast<std::size_t>(image.height_px);
}

}  // namespace

void check_range(const DisparityRange& range, int width_px, const std::string& place) {
  if (range.min_px > range.max_px) {
    throw Error(place,
                fmt::format("the disparity range {} to {} is empty", range.min_px, range.max_px),
                "give the smaller value first");
  }
  if (range.max_px >= width_px || range.min_px <= -width_px) {
    throw Error(place,
                fmt::format("the disparity range {} to {} exceeds the image width of {}",
                            range.min_px, range.max_px, width_px),
                "reduce the range");
  }
}

void check_matcher_input(const RectifiedPair& pair,
                         const DisparityRange& range,
                         const std::string& place) {
  const GreyLevels &left = pair.left, &right = pair.right;
  if (left.width_px != right.width_px || left.height_px != right.height_px) {
    throw Error(place,
                fmt::format("the left image is {}x{} and the right one {}x{}", left.width_px,
                            left.height_px, right.width_px, right.height_px),
                "use a rectified pair");
  }
  if (!is_whole(left) || !is_whole(right)) {
    throw Error(place, "the images have no pixels", "use a rectified pair");
  }
  check_range(range, left.width_px, place);
}

}  // namespace vernier::stereo::internal
