// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/ceiling.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "calib/rig.h"
#include "localise/place.h"
#include "sim/experiment.h"
#include "sim/noise_free_view.h"
#include "sim/study/floor_grid.h"
#include "sim/study/free_floor.h"
#include "sim/study/look_alike_poses.h"
#include "sim/study/upright_edges.h"
#include "sim/study/wire_frame.h"
#include "sim/visibility.h"

namespace vernier::sim::internal {

using namespace localise;

namespace {

constexpr double missing_share = 0.05;  ///< of the image length, that may differ
constexpr double same_place_m = 0.15;   ///< hypotheses that close are one, if their headings are
constexpr double same_heading_rad = 0.1;
constexpr std::size_t most_aliases = 1000;  ///< a ceiling below 0.1 % is none

/// Whether two pairs of edges gave the same pose, up to rounding.
bool is_one_pose(const Pose2D& a, const Pose2D& b) {
  return distance_m(a, b) < 1e-6 && std::abs(heading_difference_rad(a, b)) < 1e-6;
}

/// Whether all edges but a share of their length are explained.
template <class Explained>
bool mostly(const std::vector<ViewEdge>& edges,
            Explained explained,
            double may_miss = missing_share) {
  double left = 0;
  for (const ViewEdge& edge : edges) left += may_miss * edge.length_px;
  for (const ViewEdge& edge : edges) {
    if (!explained(edge)) left -= edge.length_px;
    if (left < 0) return false;
  }
  return true;
}

/// Centres of discs of radius r that hold as many points as any that holds this one: the point
/// itself, and those with it and one of those near it on the rim.
std::vector<Eigen::Vector2d> disc_centres(const Eigen::Vector2d& point,
                                          const std::vector<Eigen::Vector2d>& near,
                                          double r) {
  std::vector<Eigen::Vector2d> centres{point};
  for (const Eigen::Vector2d& other : near) {
    const Eigen::Vector2d half = (other - point) / 2;
    if (half.norm() > r || half.norm() < 1e-9) continue;
    const Eigen::Vector2d across = Eigen::Vector2d(-half.y(), half.x()).normalized();
    const double rise = std::sqrt(r * r - half.squaredNorm());
    centres.emplace_back(point + half + rise * across);
    centres.emplace_back(point + half - rise * across);
  }
  return centres;
}

/// The greatest sum of weights of points within one disc of radius r.
double heaviest_disc(const std::vector<Eigen::Vector2d>& points,
                     const std::vector<double>& weights,
                     double r) {
  double heaviest = 0;
  for (const Eigen::Vector2d& point : points) {
    std::vector<Eigen::Vector2d> near;  // no disc that holds the point holds others
    std::vector<double> weights_near;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if ((points[k] - point).norm() > 2 * r + 1e-9) continue;
      near.push_back(points[k]);
      weights_near.push_back(weights[k]);
    }
    for (const Eigen::Vector2d& centre : disc_centres(point, near, r)) {
      double sum = 0;
      for (std::size_t k = 0; k < near.size(); ++k) {
        if ((near[k] - centre).norm() <= r + 1e-9) sum += weights_near[k];
      }
      heaviest = std::max(heaviest, sum);
    }
  }
  return heaviest;
}

}  // namespace

int Aliases::elsewhere() const {
  return static_cast<int>(std::count_if(poses.begin(), poses.end(), [&](const Pose2D& other) {
    return distance_m(other, poses[0]) > right_within_m;
  }));
}

QueryCeiling query_ceiling(const Aliases& aliases) {
  if (!aliases.determined) return {};
  std::vector<Eigen::Vector2d> points;
  for (const Pose2D& pose : aliases.poses) points.emplace_back(pose.x_m, pose.y_m);
  const double all = std::accumulate(aliases.weights.begin(), aliases.weights.end(), 0.0);
  return {heaviest_disc(points, aliases.weights, right_within_m) / all, aliases.elsewhere() == 0};
}

AliasFinder::AliasFinder(const Visibility& visibility, Rig rig, NoiseFreeViewOptions options)
    : visibility_(visibility),
      rig_(std::move(rig)),
      options_(options),
      frame_(visibility.world()),
      standing_(visibility.world(), options.mount.height_m) {}

AliasFinder::View::View(std::vector<ViewEdge> all) : edges(std::move(all)) {
  constexpr std::size_t few = 64;
  if (edges.size() <= few) return;
  for (std::size_t i = 0; i < few; ++i) sample.push_back(edges[i * edges.size() / few]);
}

bool AliasFinder::on_wire_frame(const View& view, const Pose2D& pose) const {
  const FloorMotion moved(pose);
  const auto upright_fits = [&](const ViewEdge& edge) {
    if (!edge.upright) return true;  // others are checked below
    const auto [low, high] = std::minmax(edge.a_m.z(), edge.b_m.z());
    return frame_.uprights().has({moved(edge.a_m).head<2>(), low, high});
  };
  if (!view.sample.empty() && !mostly(view.sample, upright_fits, 0.25)) return false;
  return mostly(view.edges, upright_fits) && mostly(view.edges, [&](const ViewEdge& edge) {
           return edge.upright ? upright_fits(edge) : frame_.has(moved(edge.a_m), moved(edge.b_m));
         });
}

bool AliasFinder::looks_like(const std::vector<ViewEdge>& view, const Pose2D& pose) const {
  const std::vector<ViewEdge> there = edges_in_view(visibility_, rig_, options_, pose);
  const auto in = [](const std::vector<ViewEdge>& edges) {
    return [&edges](const ViewEdge& edge) {
      return std::any_of(edges.begin(), edges.end(), [&](const ViewEdge& e) {
        return lies_on(edge.a_m, e.a_m, e.b_m) && lies_on(edge.b_m, e.a_m, e.b_m);
      });
    };
  };
  return mostly(there, in(view)) && mostly(view, in(there));
}

Aliases AliasFinder::aliases(const Pose2D& pose, const QueryPlaces* places) const {
  const auto density = [&](const Pose2D& at) { return places ? places->density(at) : 1.0; };
  Aliases result;
  const View view(edges_in_view(visibility_, rig_, options_, pose));
  std::vector<Pose2D>& found = result.poses;
  std::vector<Pose2D> rejected;
  FloorGrid found_at(same_place_m), rejected_at(same_place_m);
  const auto add = [&](const Pose2D& other, double weight) {
    found_at.add({other.x_m, other.y_m}, static_cast<int>(found.size()));
    found.push_back(other);
    result.weights.push_back(weight);
  };
  add(pose, std::max(density(pose), 1.0));  // it is possible, whatever rounding says
  const auto try_one = [&](const Pose2D& other) {
    const auto same = [&](int i) {
      return distance_m(found[i], other) < same_place_m &&
             std::abs(heading_difference_rad(found[i], other)) < same_heading_rad;
    };
    const Eigen::Vector2d at(other.x_m, other.y_m);
    if (found_at.any_near(at, same_place_m, same)) return false;
    if (!standing_.in_box(at) || !on_wire_frame(view, other) || !standing_.is_free(at)) {
      return false;
    }
    if (rejected_at.any_near(at, 0, [&](int i) { return is_one_pose(rejected[i], other); })) {
      return false;
    }
    const double weight = density(other);
    if (!(weight > 0) || !looks_like(view.edges, other)) {
      rejected_at.add(at, static_cast<int>(rejected.size()));
      rejected.push_back(other);
      return false;
    }
    add(other, weight);
    return found.size() > most_aliases;
  };
  result.determined = LookAlikePoses(frame_).visit(view.edges, missing_share, try_one);
  return result;
}

}  // namespace vernier::sim::internal
