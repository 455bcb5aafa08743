// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/look_alike_poses.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "calib/base/plane_vectors.h"
#include "localise/place.h"
#include "sim/study/upright_edges.h"
#include "sim/study/wire_frame.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using namespace localise;
using vernier::internal::cross;

namespace {

using Visit = std::function<bool(const Pose2D&)>;

constexpr double slack_m = 0.01;      ///< of distances
constexpr double least_base_m = 0.3;  ///< between two uprights that give a pose
constexpr std::size_t most_pairs = 6;
constexpr int most_uprights = 48;           ///< the longest of a view, of which pairs are chosen
constexpr double most_work = 1e7;           ///< tried edges of a view, after which no pair is added
constexpr int most_level_work = 1'000'000;  ///< tried level edges of one pair

/// The pose that brings `seen_m` (robot frame) to `there_m`, after a turn.
Pose2D pose_that_brings(const Eigen::Vector2d& seen_m,
                        const Eigen::Vector2d& there_m,
                        double turn) {
  const Eigen::Vector2d at = there_m - Eigen::Rotation2Dd(turn) * seen_m;
  return {at.x(), at.y(), turn};
}

double angle(const Eigen::Vector2d& v) { return std::atan2(v.y(), v.x()); }

/// Distance of a point from a line on the floor, positive on its left.
double left_of(const Eigen::Vector2d& at,
               const Eigen::Vector2d& on_line,
               const Eigen::Vector2d& direction) {
  return cross(direction, at - on_line);
}

bool fit_uprights(const UprightEdges& world,
                  const Upright& p,
                  const Upright& q,
                  const Visit& fits) {
  const Eigen::Vector2d between = q.at_m - p.at_m;
  const UprightEdges::Matches of_p = world.matches(p), of_q = world.matches(q);
  bool enough = false;
  world.visit_all(of_p, [&](const Upright& a) {
    if (enough) return;
    world.visit_at_distance(q, of_q, a.at_m, between.norm(), slack_m, [&](const Upright& b) {
      const double turn = angle(b.at_m - a.at_m) - angle(between);
      enough = enough || fits(pose_that_brings(p.at_m, a.at_m, turn));
    });
  });
  return enough;
}

/// Direction of a level edge on the floor.
Eigen::Vector2d direction_of(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) {
  return (b_m - a_m).head<2>().normalized();
}

/// Where lines on the floor cross: p + s d = q + t e.
Eigen::Vector2d crossing(const Eigen::Vector2d& p,
                         const Eigen::Vector2d& d,
                         const Eigen::Vector2d& q,
                         const Eigen::Vector2d& e) {
  return p + cross(q - p, e) / cross(d, e) * d;
}

/// All of the floor at a height.
Eigen::AlignedBox3d at_height(double z_m) {
  constexpr double far_m = 1e9;
  const Eigen::Vector3d any(far_m, far_m, UprightEdges::tolerance_m), middle(0, 0, z_m);
  return {middle - any, middle + any};
}

bool fit_level(const WireFrame& frame, const Upright& p, const ViewEdge& level, const Visit& fits) {
  const Eigen::Vector2d along = direction_of(level.a_m, level.b_m);
  const double apart = left_of(p.at_m, level.a_m.head<2>(), along);
  const Eigen::Vector2d to_a = level.a_m.head<2>() - p.at_m, to_b = level.b_m.head<2>() - p.at_m;
  const double reach = std::max(to_a.norm(), to_b.norm()) + slack_m;
  const Eigen::Vector3d around(reach, reach, UprightEdges::tolerance_m);
  bool enough = false;
  frame.uprights().visit_all(frame.uprights().matches(p), [&](const Upright& a) {
    if (enough) return;
    const Eigen::Vector3d centre(a.at_m.x(), a.at_m.y(), level.a_m.z());
    frame.visit_level({centre - around, centre + around}, [&](const WorldSegment& segment) {
      const Eigen::Vector2d forward = direction_of(segment.a_m, segment.b_m);
      for (const Eigen::Vector2d& direction : {forward, Eigen::Vector2d(-forward)}) {
        const double there = left_of(a.at_m, segment.a_m.head<2>(), direction);
        if (enough || std::abs(there - apart) > slack_m) continue;
        enough = fits(pose_that_brings(p.at_m, a.at_m, angle(direction) - angle(along)));
      }
      return enough;
    });
  });
  return enough;
}

}  // namespace

/// Of the longest level edges those that are rarest at their height, each with the next that is not
/// parallel.
void LookAlikePoses::pair_levels(const std::vector<ViewEdge>& view,
                                 double needed_px,
                                 std::vector<Pair>& pairs) const {
  constexpr double least_sine = 0.17;  // 10 degrees
  constexpr std::size_t most_levels = 12;
  struct Level {
    int edge, alike = 0;
  };
  std::vector<Level> levels;
  for (int i = 0; i < static_cast<int>(view.size()) && levels.size() < most_levels; ++i) {
    if (!view[i].level) continue;
    Level& level = levels.emplace_back(Level{i});
    frame_.visit_level(at_height(view[i].a_m.z()), [&](const WorldSegment&) {
      ++level.alike;
      return level.alike > most_level_work;
    });
  }
  std::stable_sort(levels.begin(), levels.end(),
                   [](const Level& a, const Level& b) { return a.alike < b.alike; });
  std::vector<char> used(levels.size(), 0);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const ViewEdge& p = view[levels[i].edge];
    for (std::size_t j = i + 1; j < levels.size() && !used[i]; ++j) {
      if (needed_px <= 0 || pairs.size() >= most_pairs) return;
      const ViewEdge& q = view[levels[j].edge];
      const double sine = cross(direction_of(p.a_m, p.b_m), direction_of(q.a_m, q.b_m));
      if (used[j] || std::abs(sine) < least_sine) continue;
      used[i] = used[j] = 1;
      needed_px -= std::min(p.length_px, q.length_px);
      pairs.push_back({levels[i].edge, levels[j].edge});
    }
  }
}

/// The lines through the edges cross at one point of the view and at one of the world.
LookAlikePoses::Tried LookAlikePoses::fit_levels(const ViewEdge& p,
                                                 const ViewEdge& q,
                                                 const Visit& fits) const {
  constexpr double slack_sine = 0.01;
  const Eigen::Vector2d along_p = direction_of(p.a_m, p.b_m), along_q = direction_of(q.a_m, q.b_m);
  const Eigen::Vector2d seen = crossing(p.a_m.head<2>(), along_p, q.a_m.head<2>(), along_q);
  const double sine = cross(along_p, along_q), cosine = along_p.dot(along_q);
  double reach = 0;  // from any point of one to any of the other
  for (const Eigen::Vector3d& of_p : {p.a_m, p.b_m}) {
    for (const Eigen::Vector3d& of_q : {q.a_m, q.b_m}) {
      reach = std::max(reach, (of_p - of_q).head<2>().norm() + slack_m);
    }
  }
  const auto fit = [&](const WorldSegment& a, const WorldSegment& b, double side) {
    const Eigen::Vector2d along_a = side * direction_of(a.a_m, a.b_m);
    const Eigen::Vector2d along_b = direction_of(b.a_m, b.b_m);
    const double sine_there = cross(along_a, along_b), cosine_there = along_a.dot(along_b);
    // b is seen in one direction or the other
    if (std::abs(sine_there * cosine - cosine_there * sine) > slack_sine) return false;
    const Pose2D pose =
        pose_that_brings(seen, crossing(a.a_m.head<2>(), along_a, b.a_m.head<2>(), along_b),
                         angle(along_a) - angle(along_p));
    const FloorMotion moved(pose);
    const auto on = [&](const ViewEdge& edge, const WorldSegment& segment) {
      return lies_on(moved(edge.a_m), segment.a_m, segment.b_m) &&
             lies_on(moved(edge.b_m), segment.a_m, segment.b_m);
    };
    return on(p, a) && on(q, b) && fits(pose);
  };
  Tried tried;
  double work = 0;
  const auto is_over = [&] {
    tried.all = tried.all && ++work <= most_level_work;
    return tried.enough || !tried.all;
  };
  frame_.visit_level(at_height(p.a_m.z()), [&](const WorldSegment& a) {
    if (is_over()) return true;
    const Eigen::Vector3d around(reach, reach, UprightEdges::tolerance_m);
    Eigen::Vector3d low = a.a_m.cwiseMin(a.b_m), high = a.a_m.cwiseMax(a.b_m);
    low.z() = high.z() = q.a_m.z();
    frame_.visit_level({low - around, high + around}, [&](const WorldSegment& b) {
      if (is_over()) return true;
      tried.enough = fit(a, b, 1) || fit(a, b, -1);
      return tried.enough;
    });
    return tried.enough;
  });
  return tried;
}

/// Takes the pair that is quickest to fit for its length, again and again. Below 1 m of distance
/// headings become inexact.
void LookAlikePoses::pair_uprights(const std::vector<ViewEdge>& view,
                                   double needed_px,
                                   std::vector<Pair>& pairs,
                                   std::vector<char>& used) const {
  const UprightEdges& world = frame_.uprights();
  std::vector<int> uprights;
  std::vector<double> alike;
  for (int i = 0; i < static_cast<int>(view.size()); ++i) {
    if (!view[i].upright || uprights.size() == most_uprights) continue;
    uprights.push_back(i);
    alike.push_back(world.count_around(*upright_of(view[i])));
  }
  double done = 0;
  while (needed_px > 0 && pairs.size() < most_pairs && done < most_work) {
    Pair best{-1, -1};
    double least = std::numeric_limits<double>::infinity(), best_work = 0;
    for (std::size_t i = 0; i < uprights.size(); ++i) {
      if (used[uprights[i]]) continue;
      for (std::size_t j = i + 1; j < uprights.size(); ++j) {
        const ViewEdge &p = view[uprights[i]], &q = view[uprights[j]];  // q is the shorter one
        const double apart = (p.a_m - q.a_m).head<2>().norm();
        if (used[uprights[j]] || apart < least_base_m) continue;
        const double few = std::min(alike[i], alike[j]), many = std::max(alike[i], alike[j]);
        const double work = (1 + few) * (10 + std::min(many, world.ring_cost(apart)));
        const double per_length =
            work * std::max(1.0, 1 / (apart * apart)) / std::min(q.length_px, needed_px);
        if (per_length >= least) continue;
        least = per_length;
        best_work = work;
        best =
            alike[i] <= alike[j] ? Pair{uprights[i], uprights[j]} : Pair{uprights[j], uprights[i]};
      }
    }
    if (best.first < 0) break;
    used[best.first] = used[best.second] = 1;
    needed_px -= std::min(view[best.first].length_px, view[best.second].length_px);
    pairs.push_back(best);
    done += best_work;
  }
}

std::vector<LookAlikePoses::Pair> LookAlikePoses::pairs(const std::vector<ViewEdge>& view,
                                                        double needed_share) const {
  double needed_px = 0;
  for (const ViewEdge& edge : view) needed_px += needed_share * edge.length_px;
  std::vector<Pair> pairs;
  std::vector<char> used(view.size(), 0);
  pair_uprights(view, needed_px, pairs, used);
  for (const Pair& pair : pairs) {
    needed_px -= std::min(view[pair.first].length_px, view[pair.second].length_px);
  }
  // Uprights that found no partner: each with the longest level edge that is left.
  std::size_t level = 0;
  for (std::size_t i = 0; i < view.size() && needed_px > 0 && pairs.size() < most_pairs; ++i) {
    if (!view[i].upright || used[i]) continue;
    while (level < view.size() && !view[level].level) ++level;
    if (level == view.size()) break;
    pairs.push_back({static_cast<int>(i), static_cast<int>(level)});
    needed_px -= std::min(view[i].length_px, view[level].length_px);
    ++level;
  }
  if (pairs.empty()) pair_levels(view, needed_px, pairs);
  return pairs;
}

bool LookAlikePoses::visit(const std::vector<ViewEdge>& view,
                           double needed_share,
                           const Visit& visit) const {
  bool complete = false;  // all poses that one pair gives
  for (const auto& [first, second] : pairs(view, needed_share)) {
    const auto p = upright_of(view[first]), q = upright_of(view[second]);
    Tried tried;
    if (!p) {
      tried = fit_levels(view[first], view[second], visit);
    } else if (q) {
      tried.enough = fit_uprights(frame_.uprights(), *p, *q, visit);
    } else {
      tried.enough = fit_level(frame_, *p, view[second], visit);
    }
    complete = complete || tried.all;
    if (tried.enough) break;
  }
  return complete;
}

}  // namespace vernier::sim::internal
