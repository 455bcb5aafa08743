// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/rendered_pair.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "calib/pose.h"
#include "calib/rig.h"
#include "sim/images/image_scene.h"
#include "sim/images/render.h"
#include "sim/images/sensor_response.h"
#include "stereo/grey_levels.h"
#include "stereo/rectification.h"
#include "stereo/rectified_images.h"

namespace vernier::sim::internal {

using stereo::GreyLevels;

RenderedPair rendered_pair(const ImageScene& scene,
                           const Rig& rig,
                           const Rig& told,
                           const stereo::RectifiedGeometry& geometry,
                           const Pose& T_left_world,
                           const PairOptions& options,
                           const SensorDraws& draws) {
  std::array<GreyLevels, 2> light, noisy, clean;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const Pose T_camera_world = rig.T_camera_first[eye] * T_left_world;
    const GreyLevels radiance = render(scene, rig.cameras[eye], T_camera_world, options.render);
    light[eye] = through_lens(radiance, rig.cameras[eye], options.sensor);
  }
  SensorOptions sensor = options.sensor;
  if (sensor.exposure == 0) sensor.exposure = automatic_exposure(light[0]);
  SensorOptions ideal = sensor;
  ideal.noise = false;
  ideal.whole_levels = false;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    noisy[eye] =
        sensed(light[eye], sensor, {draws.seed, draws.image, static_cast<std::uint32_t>(eye)});
    clean[eye] = sensed(light[eye], ideal);
  }
  const int threads = options.render.threads;
  RenderedPair pair;
  pair.rectified = stereo::rectified_images(told, geometry, noisy[0], noisy[1], threads);
  pair.without_noise = stereo::rectified_images(told, geometry, clean[0], clean[1], threads).pair;
  pair.left = std::move(noisy[0]);
  pair.right = std::move(noisy[1]);
  pair.exposure = sensor.exposure;
  return pair;
}

}  // namespace vernier::sim::internal
