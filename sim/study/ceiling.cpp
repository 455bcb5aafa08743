// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/ceiling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "sim/study/floor_grid.h"
#include "sim/visibility.h"
#include "sim/visibility/box_tree.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using namespace localise;

namespace {

constexpr double tolerance_m = 0.02;
constexpr double needed_share = 0.95;
constexpr double same_place_m = 0.5;        ///< hypotheses that close are one
constexpr std::size_t most_aliases = 1000;  ///< a ceiling below 0.1 % is none

bool is_upright(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return (a - b).head<2>().norm() < 1e-6 * std::abs(a.z() - b.z());
}

Eigen::Vector3d to_world(const Pose2D& pose, const Eigen::Vector3d& x) {
  const double c = std::cos(pose.heading_rad), s = std::sin(pose.heading_rad);
  return {pose.x_m + c * x.x() - s * x.y(), pose.y_m + s * x.x() + c * x.y(), x.z()};
}

/// Whether a point lies on a segment, within the tolerance.
bool lies_on(const Eigen::Vector3d& x, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d d = b - a;
  const double t = std::clamp((x - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
  return (a + t * d - x).squaredNorm() < tolerance_m * tolerance_m;
}

template <class Edges, class Explained>
bool mostly(const Edges& edges, Explained explained) {
  double all = 0, missing = 0;
  for (const auto& edge : edges) all += edge.length_px;
  for (const auto& edge : edges) {
    if (!explained(edge)) missing += edge.length_px;
    if (missing > (1 - needed_share) * all) return false;
  }
  return true;
}

}  // namespace

AliasFinder::AliasFinder(const Visibility& visibility, Rig rig, NoiseFreeViewOptions options)
    : visibility_(visibility), rig_(std::move(rig)), options_(options) {
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(tolerance_m);
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const WorldSegment& segment : visibility.world().segments) {
    boxes.emplace_back(segment.a_m.cwiseMin(segment.b_m) - margin,
                       segment.a_m.cwiseMax(segment.b_m) + margin);
    if (!is_upright(segment.a_m, segment.b_m)) continue;
    const auto [low, high] = std::minmax(segment.a_m.z(), segment.b_m.z());
    const Eigen::Vector2d at = segment.a_m.head<2>();
    close_.add(at, static_cast<int>(uprights_.size()));
    wide_.add(at, static_cast<int>(uprights_.size()));
    uprights_.push_back({at, low, high});
  }
  segments_ = BoxTree(std::move(boxes));
}

bool AliasFinder::has_upright(const Eigen::Vector2d& at_m, double low_m, double high_m) const {
  return close_.any_near(at_m, tolerance_m, [&](int i) {
    const Upright& u = uprights_[i];
    return u.low_m < low_m + tolerance_m && u.high_m > high_m - tolerance_m &&
           (u.at_m - at_m).squaredNorm() < tolerance_m * tolerance_m;
  });
}

std::vector<AliasFinder::ViewEdge> AliasFinder::view_from(const Pose2D& pose) const {
  const Pose T = T_robot_camera(options_.mount);
  std::vector<ViewEdge> view;
  for (const VisibleEdge& edge : look(visibility_, rig_, pose, options_).edges) {
    const double length =
        (project(rig_.cameras[0], edge.a_m) - project(rig_.cameras[0], edge.b_m)).norm();
    view.push_back({T * edge.a_m, T * edge.b_m, length});
  }
  return view;
}

std::vector<Pose2D> AliasFinder::hypotheses(const std::vector<ViewEdge>& view) const {
  std::vector<Upright> seen;
  for (const ViewEdge& edge : view) {
    if (!((edge.a_m - edge.b_m).head<2>().norm() < 1e-6)) continue;
    const auto [low, high] = std::minmax(edge.a_m.z(), edge.b_m.z());
    seen.push_back({edge.a_m.head<2>(), low, high});
  }
  std::pair<int, int> base{-1, -1};
  double farthest = 0.3;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    for (std::size_t j = i + 1; j < seen.size(); ++j) {
      const double d = (seen[i].at_m - seen[j].at_m).norm();
      if (d > farthest) {
        farthest = d;
        base = {static_cast<int>(i), static_cast<int>(j)};
      }
    }
  }
  std::vector<Pose2D> poses;
  if (base.first < 0) return poses;
  const Upright &p = seen[base.first], &q = seen[base.second];
  const Eigen::Vector2d between = q.at_m - p.at_m;
  const auto can_be = [](const Upright& world, const Upright& edge) {
    return world.low_m < edge.low_m + tolerance_m && world.high_m > edge.high_m - tolerance_m;
  };
  constexpr double slack_m = 0.01;
  std::vector<int> at_distance;
  for (const Upright& a : uprights_) {
    if (!can_be(a, p)) continue;
    wide_.find_in_ring(a.at_m, farthest - 2 * slack_m, farthest + 2 * slack_m, at_distance);
    for (const int i : at_distance) {
      const Upright& b = uprights_[i];
      const Eigen::Vector2d across = b.at_m - a.at_m;
      if (std::abs(across.norm() - farthest) > slack_m || !can_be(b, q)) continue;
      const double turn = std::atan2(across.y(), across.x()) - std::atan2(between.y(), between.x());
      const Eigen::Vector3d moved = to_world({0, 0, turn}, {p.at_m.x(), p.at_m.y(), 0});
      poses.push_back({a.at_m.x() - moved.x(), a.at_m.y() - moved.y(), turn});
    }
  }
  return poses;
}

bool AliasFinder::on_wire_frame(const std::vector<ViewEdge>& view, const Pose2D& pose) const {
  const auto upright_fits = [&](const ViewEdge& edge) {
    if (!((edge.a_m - edge.b_m).head<2>().norm() < 1e-6)) return true;  // checked below
    const auto [low, high] = std::minmax(edge.a_m.z(), edge.b_m.z());
    return has_upright(to_world(pose, edge.a_m).head<2>(), low, high);
  };
  if (!mostly(view, upright_fits)) return false;
  const auto fits = [&](const ViewEdge& edge) {
    const Eigen::Vector3d a = to_world(pose, edge.a_m), b = to_world(pose, edge.b_m);
    bool found = false;
    segments_.visit(
        [&](const Eigen::AlignedBox3d& box) { return box.contains(a) && box.contains(b); },
        [&](int i) {
          const WorldSegment& segment = visibility_.world().segments[i];
          found = lies_on(a, segment.a_m, segment.b_m) && lies_on(b, segment.a_m, segment.b_m);
          return found;
        });
    return found;
  };
  return mostly(view, fits);
}

Aliases AliasFinder::aliases(const Pose2D& pose) const {
  Aliases result;
  std::vector<ViewEdge> view = view_from(pose);
  std::vector<Pose2D> found;
  FloorGrid found_at(same_place_m);
  for (const Pose2D& other : hypotheses(view)) {
    if (found.size() == most_aliases) break;
    const auto same = [&](int i) { return distance_m(found[i], other) < same_place_m; };
    const Eigen::Vector2d at(other.x_m, other.y_m);
    if (distance_m(other, pose) <= 1 || found_at.any_near(at, same_place_m, same)) continue;
    if (!on_wire_frame(view, other)) continue;
    const auto in = [](const std::vector<ViewEdge>& edges) {
      return [&edges](const ViewEdge& edge) {
        return std::any_of(edges.begin(), edges.end(), [&](const ViewEdge& e) {
          return lies_on(edge.a_m, e.a_m, e.b_m) && lies_on(edge.b_m, e.a_m, e.b_m);
        });
      };
    };
    const std::vector<ViewEdge> there = view_from(other);
    if (!mostly(there, in(view)) || !mostly(view, in(there))) continue;
    found_at.add(at, static_cast<int>(found.size()));
    found.push_back(other);
  }
  result.elsewhere = static_cast<int>(found.size());
  found.resize(std::min<std::size_t>(found.size(), 8));
  result.examples = std::move(found);
  return result;
}

}  // namespace vernier::sim::internal
