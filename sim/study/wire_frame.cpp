// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/wire_frame.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "sim/study/upright_edges.h"
#include "sim/visibility.h"
#include "sim/visibility/box_tree.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using namespace localise;

namespace {

constexpr double tolerance_m = UprightEdges::tolerance_m;

bool is_level(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) {
  constexpr double slope = 1e-6;
  return std::abs(a_m.z() - b_m.z()) < slope * (a_m - b_m).head<2>().norm();
}

}  // namespace

std::vector<ViewEdge> edges_in_view(const Visibility& visibility,
                                    const Rig& rig,
                                    const NoiseFreeViewOptions& options,
                                    const Pose2D& pose) {
  const Pose T = T_robot_camera(options.mount);
  std::vector<ViewEdge> view;
  for (const VisibleEdge& edge : look(visibility, rig, pose, options).edges) {
    const WorldSegment& segment = visibility.world().segments[edge.segment];
    const double length =
        (project(rig.cameras[0], edge.a_m) - project(rig.cameras[0], edge.b_m)).norm();
    view.push_back({T * edge.a_m, T * edge.b_m, length, is_upright(segment.a_m, segment.b_m),
                    is_level(segment.a_m, segment.b_m)});
  }
  std::stable_sort(view.begin(), view.end(),
                   [](const ViewEdge& a, const ViewEdge& b) { return a.length_px > b.length_px; });
  return view;
}

std::optional<Upright> upright_of(const ViewEdge& edge) {
  if (!edge.upright) return std::nullopt;
  const auto [low, high] = std::minmax(edge.a_m.z(), edge.b_m.z());
  return Upright{edge.a_m.head<2>(), low, high};
}

bool lies_on(const Eigen::Vector3d& x, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d d = b - a;
  const double t = std::clamp((x - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
  return (a + t * d - x).squaredNorm() < tolerance_m * tolerance_m;
}

FloorMotion::FloorMotion(const Pose2D& pose)
    : x_(pose.x_m), y_(pose.y_m), c_(std::cos(pose.heading_rad)), s_(std::sin(pose.heading_rad)) {}

WireFrame::WireFrame(const World& world) : world_(world), uprights_(world) {
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(tolerance_m);
  std::vector<Eigen::AlignedBox3d> boxes, level;
  for (std::size_t i = 0; i < world.segments.size(); ++i) {
    const WorldSegment& segment = world.segments[i];
    const Eigen::AlignedBox3d box(segment.a_m.cwiseMin(segment.b_m),
                                  segment.a_m.cwiseMax(segment.b_m));
    boxes.emplace_back(box.min() - margin, box.max() + margin);
    if (!is_level(segment.a_m, segment.b_m)) continue;
    level.push_back(box);
    level_number_.push_back(static_cast<int>(i));
  }
  segments_ = BoxTree(std::move(boxes));
  level_ = BoxTree(std::move(level));
}

bool WireFrame::has(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) const {
  bool found = false;
  segments_.visit(
      [&](const Eigen::AlignedBox3d& box) { return box.contains(a_m) && box.contains(b_m); },
      [&](int i) {
        const WorldSegment& segment = world_.segments[i];
        found = lies_on(a_m, segment.a_m, segment.b_m) && lies_on(b_m, segment.a_m, segment.b_m);
        return found;
      });
  return found;
}

}  // namespace vernier::sim::internal
