// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/image_truth.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "sim/images/depths.h"
#include "sim/images/image_scene.h"
#include "stereo/disparity_file.h"
#include "stereo/grey_levels.h"
#include "stereo/rectification.h"
#include "stereo/rectification/raw_pixels.h"

namespace vernier::sim::internal {

namespace {

/// Depths of one rectified image, NaN where the raw image has no source.
std::vector<double> known_depths(
    const ImageScene& scene, const Rig& rig, const RectifiedView& view, int eye, int threads) {
  const Camera& camera = view.rig.cameras[static_cast<std::size_t>(eye)];
  std::vector<double> depths =
      depths_m(scene, camera, eye == 0 ? view.T_left_world : view.T_right_world, threads);
  const stereo::internal::RawPixels raw(rig, view.geometry, eye);
  std::size_t i = 0;
  for (int y = 0; y < camera.size_px[1]; ++y) {
    for (int x = 0; x < camera.size_px[0]; ++x, ++i) {
      if (!raw.in_image_at({x, y})) depths[i] = std::numeric_limits<double>::quiet_NaN();
    }
  }
  return depths;
}

stereo::DisparityMap disparities(const stereo::RectifiedGeometry& geometry,
                                 const std::vector<double>& depths) {
  stereo::DisparityMap map{geometry.size_px[0], geometry.size_px[1], {}};
  map.values.reserve(depths.size());
  for (const double z : depths) map.values.push_back(static_cast<float>(geometry.disparity_px(z)));
  return map;
}

}  // namespace

RectifiedView rectified_view(const Rig& rig,
                             const stereo::RectifiedGeometry& geometry,
                             const Pose& T_left_world) {
  const auto turned = [&](int eye, const Pose& T_camera_world) {
    return Pose{stereo::internal::turn_of(geometry, eye), {0, 0, 0}} * T_camera_world;
  };
  return {geometry, stereo::rectified_rig(rig, geometry), turned(0, T_left_world),
          turned(1, rig.T_camera_first[1] * T_left_world)};
}

PairTruth pair_truth(const ImageScene& scene,
                     const Rig& rig,
                     const RectifiedView& view,
                     int threads) {
  PairTruth truth;
  truth.left_depth_m = known_depths(scene, rig, view, 0, threads);
  truth.left = disparities(view.geometry, truth.left_depth_m);
  truth.right = disparities(view.geometry, known_depths(scene, rig, view, 1, threads));
  return truth;
}

stereo::DisparityRange search_range(const stereo::DisparityMap& truth) {
  constexpr float margin_px = 2;
  float least = 0, largest = 0;
  for (const float d : truth.values) {  // comparisons are false for an unknown one
    if (d > largest) largest = d;
    if (d < least) least = d;
  }
  const int most = std::max(16, truth.width_px / 2);
  const auto bounded = [most](float size) {
    return static_cast<int>(std::ceil(std::min(size + margin_px, static_cast<float>(most))));
  };
  return {least < 0 ? -bounded(-least) : 0, bounded(largest)};
}

}  // namespace vernier::sim::internal
