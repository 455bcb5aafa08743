// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/corner_drive.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "calib/rig.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/uncertainty_source.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::sim {

using localise::Pose2D;
using localise::StereoCorner;
using vernier::internal::DrawSource;
using vernier::internal::RandomStream;

CornerAppearance::CornerAppearance(const World& world) {
  constexpr int size = 32;
  std::map<std::string, std::uint32_t> templates;  // by name, in the order of the objects
  std::vector<std::uint32_t> template_of_object;
  for (const WorldObject& object : world.objects) {
    const auto next = static_cast<std::uint32_t>(templates.size());
    template_of_object.push_back(templates.emplace(object.template_name, next).first->second);
  }
  std::vector<std::uint32_t> counted(world.objects.size());  // corners of an object so far
  for (const WorldCorner& corner : world.corners) {
    const auto object = static_cast<std::size_t>(corner.object);
    RandomStream draws({.seed = 0,
                        .trial = template_of_object[object],
                        .feature = counted[object]++,
                        .source = static_cast<std::uint32_t>(DrawSource::corner_appearance)});
    descriptors_.push_back(draws.normals(size).cast<float>().normalized());
  }
}

std::vector<StereoCorner> stereo_corners(const StereoObservation& observation,
                                         const CornerAppearance& appearance,
                                         const SourceSettings& sources) {
  constexpr double least_sigma_px = 0.02;
  const double sigma = std::max(sources.corner_sigma_px, least_sigma_px);
  std::vector<StereoCorner> corners;
  corners.reserve(observation.corners.size());
  for (const SensedCorner& seen : observation.corners) {
    corners.push_back({seen.pixel_px[0], seen.pixel_px[1],
                       sigma * sigma * Eigen::Matrix4d::Identity(),
                       appearance.of(seen.truth.feature)});
  }
  return corners;
}

CornerDrive drive_past_corners(const Visibility& visibility,
                               const Rig& true_rig,
                               const SourceSettings& sources,
                               const localise::CameraMount& mount,
                               std::span<const Pose2D> poses,
                               std::uint64_t seed,
                               std::uint32_t trial) {
  const Sensor sensor(true_rig, sources);
  const CornerAppearance appearance(visibility.world());
  NoiseFreeViewOptions looking;
  looking.mount = mount;
  looking.with_corners = true;
  CornerDrive drive;
  for (const Pose2D& pose : poses) {
    const auto moment = static_cast<std::uint32_t>(drive.moments.size());
    NoiseFreeView seen = look(visibility, true_rig, pose, looking);
    seen.edges.clear();  // only corners are sensed
    drive.moments.push_back(stereo_corners(
        sensor.sense(seen, {.seed = seed, .trial = trial, .frame = moment}), appearance, sources));
    drive.T_world_left.push_back(T_left_world(pose, mount).inverse());
  }
  return drive;
}

}  // namespace vernier::sim
