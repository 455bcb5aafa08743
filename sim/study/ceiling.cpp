// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/ceiling.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "calib/rig.h"
#include "localise/place.h"
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

constexpr double missing_share = 0.05;      ///< of the image length, that may differ
constexpr double same_place_m = 0.5;        ///< hypotheses that close are one
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

}  // namespace

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

Aliases AliasFinder::aliases(const Pose2D& pose) const {
  Aliases result;
  const View view(edges_in_view(visibility_, rig_, options_, pose));
  std::vector<Pose2D> found, rejected;
  FloorGrid found_at(same_place_m), rejected_at(same_place_m);
  const auto try_one = [&](const Pose2D& other) {
    const auto same = [&](int i) { return distance_m(found[i], other) < same_place_m; };
    const Eigen::Vector2d at(other.x_m, other.y_m);
    if (distance_m(other, pose) <= 1 || found_at.any_near(at, same_place_m, same)) return false;
    if (!standing_.in_box(at) || !on_wire_frame(view, other) || !standing_.is_free(at)) {
      return false;
    }
    if (rejected_at.any_near(at, 0, [&](int i) { return is_one_pose(rejected[i], other); })) {
      return false;
    }
    if (!looks_like(view.edges, other)) {
      rejected_at.add(at, static_cast<int>(rejected.size()));
      rejected.push_back(other);
      return false;
    }
    found_at.add(at, static_cast<int>(found.size()));
    found.push_back(other);
    return found.size() == most_aliases;
  };
  result.determined = LookAlikePoses(frame_).visit(view.edges, missing_share, try_one);
  result.elsewhere = static_cast<int>(found.size());
  found.resize(std::min<std::size_t>(found.size(), 8));
  result.examples = std::move(found);
  return result;
}

}  // namespace vernier::sim::internal
