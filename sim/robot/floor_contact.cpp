// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/robot/floor_contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "localise/place.h"
#include "sim/differential_drive.h"
#include "sim/visibility/box_tree.h"
#include "sim/world.h"
#include "sim/world/plan_distance.h"

namespace vernier::sim::internal {

using namespace localise;

namespace {

constexpr double lowest_m = 0.02;  // what lies lower is the floor itself
constexpr double touch_m = 1e-5;
constexpr double nudge_m = 1e-4;   // of a robot that touches, to see whether it comes closer
constexpr double closer_m = 1e-9;  // by more than rounding

Eigen::Vector2d place(const Pose2D& pose) { return {pose.x_m, pose.y_m}; }

}  // namespace

Obstacles::Obstacles(const World& world, double top_m) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const WorldSurface& surface : world.surfaces) {
    const auto& outline = surface.polygon_m;
    const auto [low, high] = std::minmax_element(
        outline.begin(), outline.end(), [](const auto& a, const auto& b) { return a.z() < b.z(); });
    if (low->z() > top_m || high->z() < lowest_m) continue;
    for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
      const Eigen::Vector2d a = outline[j].head<2>(), b = outline[i].head<2>();
      sides_.emplace_back(a, b);
      Eigen::AlignedBox3d& box = boxes.emplace_back();
      box.extend(Eigen::Vector3d(a.x(), a.y(), 0));
      box.extend(Eigen::Vector3d(b.x(), b.y(), 0));
    }
  }
  tree_ = BoxTree(std::move(boxes));
}

double Obstacles::distance_m(const Eigen::Vector2d& at_m, double within_m) const {
  const Eigen::Vector3d at(at_m.x(), at_m.y(), 0);
  double nearest = within_m;
  tree_.visit(
      [&](const Eigen::AlignedBox3d& box) {
        return box.squaredExteriorDistance(at) < nearest * nearest;
      },
      [&](int i) {
        const auto& [a, b] = sides_[static_cast<std::size_t>(i)];
        nearest = std::min(nearest, plan_distance(at_m, a, b));
        return false;
      });
  return nearest;
}

Obstacles::Advance Obstacles::advance(const Pose2D& start,
                                      std::span<const DrivePhase> phases,
                                      double radius_m) const {
  constexpr double look_m = 1;  // farther away nothing is sought
  Advance reached{start, 0, false};
  for (const DrivePhase& phase : phases) {
    const Pose2D begin = reached.pose;
    const double fastest = std::max(std::abs(phase.speed0_mps), std::abs(phase.speed1_mps));
    const double begin_s = reached.time_s;
    double t = 0;
    while (t < phase.duration_s) {
      const double gap = distance_m(place(reached.pose), radius_m + look_m) - radius_m;
      const double free = gap > touch_m ? gap - 0.5 * touch_m : nudge_m;
      const double next =
          fastest > 0 ? std::min(phase.duration_s, t + free / fastest) : phase.duration_s;
      const Pose2D pose = compose(begin, phase.after(next));
      if (gap <= touch_m) {
        const double then = distance_m(place(pose), radius_m + look_m) - radius_m;
        if (then < gap - closer_m) {
          reached.contact = true;
          return reached;
        }
      }
      t = next;
      reached.pose = pose;
      reached.time_s = begin_s + t;
    }
  }
  return reached;
}

}  // namespace vernier::sim::internal
