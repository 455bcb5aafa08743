// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/noise_free_view.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "sim/visibility.h"
#include "sim/visibility/stretch_feature.h"
#include "sim/world.h"

namespace vernier::sim {

using namespace localise;
using namespace internal;

namespace {

/// Intersection of two sorted lists of runs of one segment.
template <class Visit>
void for_common_stretches(const std::vector<VisibleInterval>& left,
                          const std::vector<VisibleInterval>& right,
                          Visit visit) {
  std::size_t i = 0, j = 0;
  int segment = -1, count = 0;
  while (i < left.size() && j < right.size()) {
    const VisibleInterval &l = left[i], &r = right[j];
    if (l.segment != r.segment) {
      (l.segment < r.segment ? i : j)++;
      continue;
    }
    if (l.segment != segment) {
      segment = l.segment;
      count = 0;
    }
    const double t0 = std::max(l.t0, r.t0), t1 = std::min(l.t1, r.t1);
    if (t0 < t1) visit(VisibleInterval{segment, count++, t0, t1});
    (l.t1 < r.t1 ? i : j)++;
  }
}

/// The segments of runs, each once.
std::vector<int> segments_of(const std::vector<VisibleInterval>& runs) {
  std::vector<int> segments;
  for (const VisibleInterval& run : runs) {
    if (segments.empty() || segments.back() != run.segment) segments.push_back(run.segment);
  }
  return segments;
}

}  // namespace

Pose T_left_world(const Pose2D& pose, const CameraMount& mount, double roll_rad) {
  const Pose T_world_robot{rotation_from_vector({0, 0, pose.heading_rad}), {pose.x_m, pose.y_m, 0}};
  const Pose T_world_left = T_world_robot * T_robot_camera(mount);
  if (roll_rad == 0) return T_world_left.inverse();
  return (T_world_left * Pose{rotation_from_vector({0, 0, roll_rad}), {0, 0, 0}}).inverse();
}

NoiseFreeView look(const Visibility& visibility,
                   const Rig& rig,
                   const Pose2D& pose,
                   const NoiseFreeViewOptions& options) {
  if (rig.cameras.size() != 2) {
    throw Error("simulation", "the rig has " + std::to_string(rig.cameras.size()) + " cameras",
                "use a rig of two cameras");
  }
  const World& world = visibility.world();
  const Pose T_left = T_left_world(pose, options.mount, options.roll_rad);
  const Pose T_right = rig.T_camera_first[1] * T_left;
  // The length limit applies to the part visible in both cameras.
  VisibilityOptions any_length = options.visibility;
  any_length.min_length_px = 0;
  const auto left = visibility.visible_intervals(rig.cameras[0], T_left, any_length);
  const auto right =
      visibility.visible_intervals_of(segments_of(left), rig.cameras[1], T_right, any_length);

  NoiseFreeView seen{pose, {}, {}};
  for_common_stretches(left, right, [&](const VisibleInterval& run) {
    const WorldSegment& segment = world.segments[run.segment];
    const Eigen::Vector3d d = segment.b_m - segment.a_m;
    const Eigen::Vector3d a = T_left * (segment.a_m + run.t0 * d);
    const Eigen::Vector3d b = T_left * (segment.a_m + run.t1 * d);
    const double length = (project(rig.cameras[0], a) - project(rig.cameras[0], b)).norm();
    if (length < options.visibility.min_length_px) return;
    const std::uint32_t feature = stretch_feature(run.segment, run.run, world.segments.size());
    seen.edges.push_back({a, b, run.segment, feature, segment.object,
                          T_left * world.objects.at(segment.object).centre_m});
  });
  if (options.with_corners) {
    const auto corners_left =
        visibility.visible_corners(rig.cameras[0], T_left, options.visibility);
    const auto corners_right =
        visibility.visible_corners(rig.cameras[1], T_right, options.visibility);
    std::vector<int> both;
    std::set_intersection(corners_left.begin(), corners_left.end(), corners_right.begin(),
                          corners_right.end(), std::back_inserter(both));
    for (const int corner : both) {
      seen.corners.push_back(
          {T_left * world.corners[corner].position_m, static_cast<std::uint32_t>(corner)});
    }
  }
  return seen;
}

}  // namespace vernier::sim
