// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/ceiling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "sim/study/floor_grid.h"
#include "sim/study/upright_edges.h"
#include "sim/visibility.h"
#include "sim/visibility/box_tree.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using namespace localise;

namespace {

constexpr double tolerance_m = UprightEdges::tolerance_m;
constexpr double slack_m = 0.01;      ///< of distances in a hypothesis
constexpr double least_base_m = 0.3;  ///< between two uprights that give a pose
constexpr double needed_share = 0.95;
constexpr double same_place_m = 0.5;        ///< hypotheses that close are one
constexpr std::size_t most_aliases = 1000;  ///< a ceiling below 0.1 % is none

/// What an upright edge of a view is; nothing for other edges.
template <class Edge>
std::optional<Upright> upright(const Edge& edge) {
  if (!is_upright(edge.a_m, edge.b_m)) return std::nullopt;
  const auto [low, high] = std::minmax(edge.a_m.z(), edge.b_m.z());
  return Upright{edge.a_m.template head<2>(), low, high};
}

/// The pose that brings `seen_m` (robot frame) to `there_m`, after a turn.
Pose2D pose_that_brings(const Eigen::Vector2d& seen_m,
                        const Eigen::Vector2d& there_m,
                        double turn) {
  const Eigen::Vector2d at = there_m - Eigen::Rotation2Dd(turn) * seen_m;
  return {at.x(), at.y(), turn};
}

double angle(const Eigen::Vector2d& v) { return std::atan2(v.y(), v.x()); }

Eigen::Vector3d to_world(const Pose2D& pose, const Eigen::Vector3d& x) {
  const double c = std::cos(pose.heading_rad), s = std::sin(pose.heading_rad);
  return {pose.x_m + c * x.x() - s * x.y(), pose.y_m + s * x.x() + c * x.y(), x.z()};
}

bool is_level(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) {
  constexpr double slope = 1e-6;
  return std::abs(a_m.z() - b_m.z()) < slope * (a_m - b_m).head<2>().norm();
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
    : visibility_(visibility),
      rig_(std::move(rig)),
      options_(options),
      uprights_(visibility.world()) {
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(tolerance_m);
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const WorldSegment& segment : visibility.world().segments) {
    boxes.emplace_back(segment.a_m.cwiseMin(segment.b_m) - margin,
                       segment.a_m.cwiseMax(segment.b_m) + margin);
  }
  segments_ = BoxTree(std::move(boxes));
}

std::vector<AliasFinder::ViewEdge> AliasFinder::view_from(const Pose2D& pose) const {
  const Camera& camera = rig_.cameras[0];
  const Pose T_camera_world = T_left_world(pose, options_.mount);
  const Pose T_robot_world = T_robot_camera(options_.mount) * T_camera_world;
  std::vector<ViewEdge> view;
  for (const VisibleInterval& run :
       visibility_.visible_intervals(camera, T_camera_world, options_.visibility)) {
    const WorldSegment& segment = visibility_.world().segments[run.segment];
    const Eigen::Vector3d d = segment.b_m - segment.a_m;
    const Eigen::Vector3d a = segment.a_m + run.t0 * d, b = segment.a_m + run.t1 * d;
    const double length =
        (project(camera, T_camera_world * a) - project(camera, T_camera_world * b)).norm();
    view.push_back({T_robot_world * a, T_robot_world * b, length});
  }
  std::stable_sort(view.begin(), view.end(),
                   [](const ViewEdge& a, const ViewEdge& b) { return a.length_px > b.length_px; });
  return view;
}

std::optional<std::vector<Pose2D>> AliasFinder::hypotheses(
    const std::vector<ViewEdge>& view) const {
  struct Seen {
    Upright part;
    double alike;  // in the world
  };
  std::vector<Seen> seen;
  const ViewEdge* level = nullptr;  // the longest
  for (const ViewEdge& edge : view) {
    if (const auto part = upright(edge)) {
      seen.push_back({*part, static_cast<double>(uprights_.count_around(*part))});
    } else if (!level && is_level(edge.a_m, edge.b_m)) {
      level = &edge;
    }
  }
  std::vector<Pose2D> poses;
  const Seen *p = nullptr, *q = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < seen.size(); ++i) {
    for (std::size_t j = i + 1; j < seen.size(); ++j) {
      const double apart = (seen[i].part.at_m - seen[j].part.at_m).norm();
      const double alike = seen[i].alike * seen[j].alike / apart;
      if (apart < least_base_m || alike >= least) continue;
      least = alike;
      p = &seen[i];
      q = &seen[j];
    }
  }
  if (p) {
    if (p->alike > q->alike) std::swap(p, q);
    fit_uprights(p->part, q->part, poses);
    return poses;
  }
  if (seen.empty() || !level) return std::nullopt;
  const auto rarest = std::min_element(
      seen.begin(), seen.end(), [](const Seen& a, const Seen& b) { return a.alike < b.alike; });
  fit_level(rarest->part, *level, poses);
  return poses;
}

void AliasFinder::fit_uprights(const Upright& p,
                               const Upright& q,
                               std::vector<Pose2D>& poses) const {
  const Eigen::Vector2d between = q.at_m - p.at_m;
  uprights_.visit_all(p, [&](const Upright& a) {
    uprights_.visit_at_distance(q, a.at_m, between.norm(), slack_m, [&](const Upright& b) {
      poses.push_back(pose_that_brings(p.at_m, a.at_m, angle(b.at_m - a.at_m) - angle(between)));
    });
  });
}

void AliasFinder::fit_level(const Upright& p,
                            const ViewEdge& level,
                            std::vector<Pose2D>& poses) const {
  const Eigen::Vector2d along = (level.b_m - level.a_m).head<2>().normalized();
  const auto beside = [&](const Eigen::Vector2d& at, const Eigen::Vector2d& direction,
                          const Eigen::Vector2d& from) {
    const Eigen::Vector2d d = at - from;
    return direction.x() * d.y() - direction.y() * d.x();
  };
  const double apart = beside(p.at_m, along, level.a_m.head<2>());
  const double reach =
      std::max((level.a_m.head<2>() - p.at_m).norm(), (level.b_m.head<2>() - p.at_m).norm()) +
      slack_m;
  uprights_.visit_all(p, [&](const Upright& a) {
    const Eigen::Vector3d low(a.at_m.x() - reach, a.at_m.y() - reach, level.a_m.z() - tolerance_m);
    const Eigen::Vector3d high(a.at_m.x() + reach, a.at_m.y() + reach, level.a_m.z() + tolerance_m);
    const Eigen::AlignedBox3d around(low, high);
    segments_.visit(
        [&](const Eigen::AlignedBox3d& box) { return around.intersects(box); },
        [&](int i) {
          const WorldSegment& segment = visibility_.world().segments[i];
          if (!is_level(segment.a_m, segment.b_m)) return false;
          const Eigen::Vector2d forward = (segment.b_m - segment.a_m).head<2>().normalized();
          for (const Eigen::Vector2d& direction : {forward, Eigen::Vector2d(-forward)}) {
            if (std::abs(beside(a.at_m, direction, segment.a_m.head<2>()) - apart) > slack_m) {
              continue;
            }
            poses.push_back(pose_that_brings(p.at_m, a.at_m, angle(direction) - angle(along)));
          }
          return false;
        });
  });
}

bool AliasFinder::on_a_segment(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) const {
  bool found = false;
  segments_.visit(
      [&](const Eigen::AlignedBox3d& box) { return box.contains(a_m) && box.contains(b_m); },
      [&](int i) {
        const WorldSegment& segment = visibility_.world().segments[i];
        found = lies_on(a_m, segment.a_m, segment.b_m) && lies_on(b_m, segment.a_m, segment.b_m);
        return found;
      });
  return found;
}

bool AliasFinder::on_wire_frame(const std::vector<ViewEdge>& view, const Pose2D& pose) const {
  const auto moved = [&](const ViewEdge& edge) {
    return ViewEdge{to_world(pose, edge.a_m), to_world(pose, edge.b_m), edge.length_px};
  };
  const auto upright_fits = [&](const ViewEdge& edge) {
    const auto part = upright(moved(edge));
    return !part || uprights_.has(*part);  // others are checked below
  };
  if (!mostly(view, upright_fits)) return false;
  return mostly(view, [&](const ViewEdge& edge) {
    const ViewEdge there = moved(edge);
    return on_a_segment(there.a_m, there.b_m);
  });
}

Aliases AliasFinder::aliases(const Pose2D& pose) const {
  Aliases result;
  std::vector<ViewEdge> view = view_from(pose);
  std::vector<Pose2D> found;
  FloorGrid found_at(same_place_m);
  const auto tried = hypotheses(view);
  if (!tried) {
    result.determined = false;
    return result;
  }
  for (const Pose2D& other : *tried) {
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
