// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/rectified_images.h"

#include <fmt/format.h>

#include <algorithm>

#include "calib/error.h"
#include "calib/ordered_parallel.h"
#include "stereo/matrix_of.h"
#include "stereo/patch_alignment.h"

namespace vernier {
namespace {

void check(const Camera& camera, const GreyLevels& image) {
  const auto pixels =
      static_cast<std::size_t>(camera.size_px[0]) * static_cast<std::size_t>(camera.size_px[1]);
  if (Eigen::Vector2i(image.width_px, image.height_px) == camera.size_px &&
      image.values.size() == pixels) {
    return;
  }
  throw Error("rectification",
              fmt::format("the image of camera \"{}\" is {}x{} px with {} values, the camera takes "
                          "{}x{} px",
                          camera.name, image.width_px, image.height_px, image.values.size(),
                          camera.size_px[0], camera.size_px[1]),
              "give the images that the rig took");
}

void rectify(const Rig& rig,
             const RectifiedGeometry& geometry,
             int camera,
             const GreyLevels& raw,
             int threads,
             GreyLevels& rectified,
             ValidPixels& valid) {
  const int width = geometry.size_px[0], height = geometry.size_px[1];
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  rectified = {width, height, std::vector<float>(pixels)};
  valid = {width, height, std::vector<std::uint8_t>(pixels)};
  const cv::Mat image = matrix_of(raw);
  const RawPixels source(rig, geometry, camera);
  for_each_index(static_cast<std::size_t>(height), threads, [&](std::size_t y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = y * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
      const auto at = source.at({static_cast<double>(x), static_cast<double>(y)});
      if (!at) continue;
      valid.values[i] = in_image(rig.cameras[static_cast<std::size_t>(camera)], *at);
      const double u = std::clamp(at->x(), 0.0, raw.width_px - 1.0);
      const double v = std::clamp(at->y(), 0.0, raw.height_px - 1.0);
      rectified.values[i] = static_cast<float>(std::clamp(grey_between(image, u, v), 0.0, 255.0));
    }
  });
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
                "give a rig of two");
  }
  check(rig.cameras[0], left);
  check(rig.cameras[1], right);
  RectifiedImages images;
  rectify(rig, geometry, 0, left, threads, images.pair.left, images.left_valid);
  rectify(rig, geometry, 1, right, threads, images.pair.right, images.right_valid);
  return images;
}

}  // namespace vernier
