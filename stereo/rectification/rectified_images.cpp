// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/rectified_images.h"

#include <fmt/format.h>

#include <algorithm>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "stereo/grey_levels.h"
#include "stereo/image/image_noise.h"
#include "stereo/image/matrix_of.h"
#include "stereo/image/resampled_image.h"
#include "stereo/rectification.h"
#include "stereo/rectification/raw_pixels.h"

namespace vernier::stereo {

using namespace internal;

namespace {

void check(const Camera& camera, const GreyLevels& image) {
  const auto pixels =
      static_cast<std::size_t>(camera.size_px[0]) * static_cast<std::size_t>(camera.size_px[1]);
  if (Eigen::Vector2i(image.width_px, image.height_px) == camera.size_px &&
      image.values.size() == pixels) {
    return;
  }
  throw Error("rectification",
              fmt::format("the image of camera \"{}\" is {}x{} px with {} values, the camera has "
                          "{}x{} px",
                          camera.name, image.width_px, image.height_px, image.values.size(),
                          camera.size_px[0], camera.size_px[1]),
              "use the images of this rig");
}

void rectify(const Rig& rig,
             const RectifiedGeometry& geometry,
             int camera,
             const GreyLevels& raw,
             int threads,
             GreyLevels& rectified,
             ValidPixels& valid) {
  const int width = geometry.size_px[0], height = geometry.size_px[1];
  valid = {width, height,
           std::vector<std::uint8_t>(static_cast<std::size_t>(width) *
                                     static_cast<std::size_t>(height))};
  const RawPixels raw_pixels(rig, geometry, camera);
  const auto source = [&](int x, int y) {
    auto at = raw_pixels.at({static_cast<double>(x), static_cast<double>(y)});
    if (at) {
      valid.values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(x)] =
          in_image(rig.cameras[static_cast<std::size_t>(camera)], *at);
    }
    return at;
  };
  rectified = resampled(raw, geometry.size_px, source, threads);
}

SourceNoise source_noise(const Camera& camera,
                         const RectifiedGeometry& geometry,
                         const GreyLevels& raw) {
  return {image_noise(matrix_of(raw)), std::max(1.0, geometry.f_px / camera.f_px())};
}

}  // namespace

double ValidPixels::blank_share() const {
  if (values.empty()) return 0;
  return static_cast<double>(std::count(values.begin(), values.end(), 0)) /
         static_cast<double>(values.size());
}

RectifiedImages rectified_images(const Rig& rig,
                                 const RectifiedGeometry& geometry,
                                 const GreyLevels& left,
                                 const GreyLevels& right,
                                 int threads) {
  if (rig.cameras.size() != 2) {
    throw Error("rectification", fmt::format("the rig has {} cameras", rig.cameras.size()),
                "use a rig of two cameras");
  }
  check(rig.cameras[0], left);
  check(rig.cameras[1], right);
  RectifiedImages images;
  rectify(rig, geometry, 0, left, threads, images.pair.left, images.left_valid);
  rectify(rig, geometry, 1, right, threads, images.pair.right, images.right_valid);
  images.pair.left_noise = source_noise(rig.cameras[0], geometry, left);
  images.pair.right_noise = source_noise(rig.cameras[1], geometry, right);
  return images;
}

}  // namespace vernier::stereo
