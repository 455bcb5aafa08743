// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/noise_ceiling.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>

#include "calib/rig.h"
#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/sources/sensed_check.h"
#include "sim/study/ceiling.h"
#include "sim/study/floor_grid.h"
#include "sim/study/look_alike_poses.h"
#include "sim/study/wire_frame.h"
#include "sim/visibility.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

using namespace localise;

namespace {

constexpr double pair_share = 0.3;      ///< of the image length, for pairs that give rivals
constexpr double on_frame_share = 0.5;  ///< of it, that lies on the wire frame
constexpr double same_rival_m = 0.05;
constexpr std::size_t most_improved = 10;

}  // namespace

NoiseCeiling::NoiseCeiling(const Visibility& visibility,
                           const Rig& rig,
                           NoiseFreeViewOptions options,
                           const SourceSettings& sources)
    : visibility_(visibility),
      rig_(rig),
      options_(options),
      sensor_(rig, sources),
      likelihood_(rig, sources),
      frame_(visibility.world()),
      standing_(visibility.world(), options.mount.height_m) {}

double NoiseCeiling::score(const std::vector<stereo::StereoSegment>& sensed,
                           const Pose2D& pose) const {
  return likelihood_.log_likelihood(sensed, look(visibility_, rig_, pose, options_));
}

NoiseCeiling::Scored NoiseCeiling::improved(const std::vector<stereo::StereoSegment>& sensed,
                                            Scored best) const {
  double step_m = 0.05, turn = std::numbers::pi / 180;
  for (int level = 0; level < 5; ++level, step_m /= 2, turn /= 2) {
    const Pose2D centre = best.pose;
    for (const Pose2D& step : {Pose2D{step_m, 0, 0}, Pose2D{-step_m, 0, 0}, Pose2D{0, step_m, 0},
                               Pose2D{0, -step_m, 0}, Pose2D{0, 0, turn}, Pose2D{0, 0, -turn}}) {
      const Pose2D tried = compose(centre, step);
      const double at_tried = score(sensed, tried);
      if (at_tried > best.score) best = {tried, at_tried};
    }
  }
  return best;
}

std::optional<std::vector<Pose2D>> NoiseCeiling::rivals(const Pose2D& pose) const {
  const std::vector<ViewEdge> view = edges_in_view(visibility_, rig_, options_, pose);
  double all_px = 0;
  for (const ViewEdge& edge : view) all_px += edge.length_px;
  std::vector<Pose2D> found;
  FloorGrid found_at(same_rival_m);
  const bool determined = LookAlikePoses(frame_).visit(view, pair_share, [&](const Pose2D& other) {
    const Eigen::Vector2d at(other.x_m, other.y_m);
    const auto same = [&](int i) { return distance_m(found[i], other) < same_rival_m; };
    if (distance_m(other, pose) <= right_within_m || !standing_.in_box(at)) return false;
    if (found_at.any_near(at, same_rival_m, same)) return false;
    const FloorMotion moved(other);
    double on_frame_px = 0;
    for (const ViewEdge& edge : view) {
      if (frame_.has(moved(edge.a_m), moved(edge.b_m))) on_frame_px += edge.length_px;
    }
    if (on_frame_px < on_frame_share * all_px || !standing_.is_free(at)) return false;
    found_at.add(at, static_cast<int>(found.size()));
    found.push_back(other);
    return false;
  });
  if (!determined) return std::nullopt;
  return found;
}

NoisyLook NoiseCeiling::look_from(const Pose2D& pose, const SensingDraw& draw) const {
  const StereoObservation seen = sensor_.sense(look(visibility_, rig_, pose, options_), draw);
  const auto& sensed = require_sensed(seen).segments;
  NoisyLook result;
  result.elsewhere = -std::numeric_limits<double>::infinity();
  result.here = improved(sensed, {pose, score(sensed, pose)}).score;
  const auto found = rivals(pose);
  result.determined = found.has_value();
  if (!found) return result;
  std::vector<Scored> others;
  for (const Pose2D& rival : *found) others.push_back({rival, score(sensed, rival)});
  result.rivals = static_cast<int>(others.size());
  std::stable_sort(others.begin(), others.end(),
                   [](const Scored& a, const Scored& b) { return a.score > b.score; });
  others.resize(std::min(others.size(), most_improved));
  for (const Scored& other : others) {
    const Scored best = improved(sensed, other);
    if (best.score <= result.elsewhere) continue;
    result.elsewhere = best.score;
    result.best_rival = best.pose;
  }
  return result;
}

}  // namespace vernier::sim::internal
