// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/corner_appearance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "calib/error.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "localise/place.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/uncertainty_source.h"
#include "sim/world.h"

namespace vernier::sim {

using localise::StereoCorner;
using vernier::internal::DrawSource;
using vernier::internal::RandomStream;

namespace {

constexpr int descriptor_size = 32;

RandomStream draws_of_corner(std::uint32_t of_template, std::uint32_t index) {
  return RandomStream({.seed = 0,
                       .trial = of_template,
                       .feature = index,
                       .source = static_cast<std::uint32_t>(DrawSource::corner_appearance)});
}

Eigen::VectorXf direction(RandomStream& draws) {
  return draws.normals(descriptor_size).cast<float>().normalized();
}

}  // namespace

void check(const AppearanceOptions& options, const std::string& place) {
  constexpr double most = 100;
  const auto in_range = [](double value) { return value >= 0 && value <= most; };
  if (!in_range(options.view_change)) {
    throw Error(place, "view_change is not from 0 to 100", "use 1");
  }
  if (!in_range(options.noise)) throw Error(place, "noise is not from 0 to 100", "use 0.3");
}

CornerAppearance::CornerAppearance(const World& world, const AppearanceOptions& options)
    : options_(options) {
  check(options, "corner appearance");
  std::map<std::string, std::uint32_t> templates;  // by name, in the order of the objects
  std::vector<std::uint32_t> template_of_object;
  for (const WorldObject& object : world.objects) {
    const auto next = static_cast<std::uint32_t>(templates.size());
    template_of_object.push_back(templates.emplace(object.template_name, next).first->second);
  }
  std::vector<std::uint32_t> counted(world.objects.size());  // corners of an object so far
  keys_.reserve(world.corners.size());
  for (const WorldCorner& corner : world.corners) {
    const auto object = static_cast<std::size_t>(corner.object);
    keys_.push_back({template_of_object[object], counted[object]++, world.objects[object].yaw_rad,
                     corner.position_m.head<2>()});
  }
}

Eigen::VectorXf CornerAppearance::of(std::uint32_t corner) const {
  RandomStream draws = draws_of_corner(keys_[corner].of_template, keys_[corner].index);
  return direction(draws);
}

Eigen::VectorXf CornerAppearance::seen(std::uint32_t corner,
                                       const Eigen::Vector3d& eye_m,
                                       const SensingDraw& draw) const {
  const Key& key = keys_[corner];
  RandomStream draws = draws_of_corner(key.of_template, key.index);
  Eigen::VectorXf seen = direction(draws);
  if (options_.view_change > 0) {
    const Eigen::Vector2d to_eye_m = eye_m.head<2>() - key.at_m;
    const double bearing = std::atan2(to_eye_m.y(), to_eye_m.x()) - key.yaw_rad;
    const Eigen::VectorXf c = direction(draws), s = direction(draws);
    seen += static_cast<float>(options_.view_change * std::cos(bearing)) * c +
            static_cast<float>(options_.view_change * std::sin(bearing)) * s;
    seen.normalize();
  }
  if (options_.noise > 0) {
    RandomStream noise({.seed = draw.seed,
                        .trial = draw.trial,
                        .feature = corner,
                        .source = static_cast<std::uint32_t>(DrawSource::corner_sighting),
                        .frame = draw.frame});
    const double share = options_.noise / std::sqrt(descriptor_size);
    seen += (share * noise.normals(descriptor_size)).cast<float>();
    seen.normalize();
  }
  return seen;
}

std::vector<StereoCorner> stereo_corners(const StereoObservation& observation,
                                         const CornerAppearance& appearance,
                                         const SourceSettings& sources,
                                         const Eigen::Vector3d& eye_m,
                                         const SensingDraw& draw) {
  constexpr double least_sigma_px = 0.02;
  const double sigma = std::max(sources.corner_sigma_px, least_sigma_px);
  std::vector<StereoCorner> corners;
  corners.reserve(observation.corners.size());
  for (const SensedCorner& seen : observation.corners) {
    corners.push_back({seen.pixel_px[0], seen.pixel_px[1],
                       sigma * sigma * Eigen::Matrix4d::Identity(),
                       appearance.seen(seen.truth.feature, eye_m, draw)});
  }
  return corners;
}

Eigen::Vector3d eye_of(const localise::Pose2D& pose, const localise::CameraMount& mount) {
  return {pose.x_m, pose.y_m, mount.height_m};
}

}  // namespace vernier::sim
