// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/corners/described_corners.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "stereo/corners/corner_image.h"
#include "stereo/corners/corner_match.h"
#include "stereo/corners/corner_matching.h"
#include "stereo/corners/epipolar_band.h"
#include "stereo/corners/patch_descriptor.h"
#include "stereo/grey_levels.h"
#include "stereo/image/matrix_of.h"

namespace vernier::stereo::internal {

namespace {

void check_same_size(const GreyLevels& image, const Camera& camera) {
  if (image.width_px == camera.size_px[0] && image.height_px == camera.size_px[1]) return;
  throw Error(camera.name + " image",
              fmt::format("is {}x{} pixels, but the rig's camera has {}x{}", image.width_px,
                          image.height_px, camera.size_px[0], camera.size_px[1]),
              "give the rig that took the images");
}

/// How much both images may be brightened before they are rounded to bytes. Values of 12 bits in a
/// file of 16 use 16 of 256 levels.
double headroom(const GreyLevels& left, const GreyLevels& right) {
  constexpr float full = 255;
  float largest = 1;
  for (const GreyLevels* image : {&left, &right}) {
    for (const float value : image->values) largest = std::max(largest, value);
  }
  return 2 * largest < full ? full / largest : 1;
}

}  // namespace

std::vector<DescribedCorner> described_corners(const Rig& rig,
                                               const Eigen::MatrixXd& covariance,
                                               const GreyLevels& left,
                                               const GreyLevels& right,
                                               const DescribedCornerOptions& options) {
  const EpipolarBand band(rig, covariance, {.nearest_m = options.nearest_m});
  check_same_size(left, rig.cameras[0]);
  check_same_size(right, rig.cameras[1]);
  const double gain = headroom(left, right);
  const auto [in_left, in_right] =
      corner_images(bytes_of(left, gain), bytes_of(right, gain), rig,
                    {.count = options.corners, .cells = options.cells});
  const PatchDescriptors descriptors(in_left.grey);
  std::vector<DescribedCorner> corners;
  for (const CornerMatch& match : match_corners(in_left, in_right, band)) {
    if (auto descriptor = descriptors.at(in_left.reduced(match.left_px))) {
      corners.push_back({match, std::move(*descriptor)});
    }
  }
  return corners;
}

}  // namespace vernier::stereo::internal
