// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/sequence/expected_lines.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <variant>

#include "calib/camera.h"
#include "calib/camera/opencv_intrinsics.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/statistics/quantile.h"
#include "localise/join/line_fit.h"
#include "localise/joined_lines.h"
#include "sim/sequence/line_in_view.h"
#include "sim/sequence/sequence_samples.h"

namespace vernier::sim::internal {

using namespace localise;
using namespace localise::internal;
using Eigen::Vector3d;

namespace {

/// Stretches that at least `least` of these intervals cover.
std::vector<std::pair<double, double>> covered_by(
    const std::vector<std::pair<double, double>>& intervals, int least) {
  std::vector<std::pair<double, int>> steps;
  for (const auto& [low, high] : intervals) {
    steps.emplace_back(low, 1);
    steps.emplace_back(high, -1);
  }
  std::sort(steps.begin(), steps.end());
  std::vector<std::pair<double, double>> covered;
  int depth = 0;
  for (const auto& [at, step] : steps) {
    if (depth < least && depth + step >= least) covered.emplace_back(at, at);
    if (depth >= least && depth + step < least) covered.back().second = at;
    depth += step;
  }
  return covered;
}

/// The median of those of `ends` that lie within `near_m` of `end`.
double settled(const std::vector<double>& ends, double end, double near_m) {
  std::vector<double> close;
  for (const double e : ends) {
    if (std::abs(e - end) <= near_m) close.push_back(e);
  }
  return close.empty() ? end : vernier::internal::median_or_zero(std::move(close));
}

/// Stretches seen by at least `least` of the intervals, each with settled ends.
std::vector<std::pair<double, double>> stretches(
    const std::vector<std::pair<double, double>>& intervals, int least, double near_m) {
  std::vector<double> lows, highs;
  for (const auto& [low, high] : intervals) {
    lows.push_back(low);
    highs.push_back(high);
  }
  std::vector<std::pair<double, double>> settled_ones;
  for (const auto& [low, high] : covered_by(intervals, least)) {
    const double from = settled(lows, low, near_m), to = settled(highs, high, near_m);
    if (to > from) settled_ones.emplace_back(from, to);
  }
  return settled_ones;
}

JoinedLines joined_lines_of(std::span<const SequenceView> views, const JoinOptions& options) {
  std::vector<SegmentsOfView> all;
  for (const SequenceView& view : views) {
    all.push_back({view.T_world_camera, {}});
    for (const SequenceSegment& segment : view.segments) {
      all.back().segments.push_back(segment.in_space);
    }
  }
  return join_lines(all, options);
}

}  // namespace

bool KnownLine::seen_at(double station_m) const {
  return std::any_of(seen_m.begin(), seen_m.end(), [&](const auto& stretch) {
    return station_m >= stretch.first && station_m <= stretch.second;
  });
}

double KnownLine::across_px2(const PlacedCamera& camera,
                             const Eigen::Vector2d& across,
                             double station_m,
                             std::optional<double> less_station_m) const {
  const auto row = [&](double s) -> Eigen::RowVector4d {
    const Vector3d p = camera.T_camera_world * at(s);
    Eigen::Matrix<double, 2, 3> J;
    J << camera.k.fx_px / p.z(), 0, -camera.k.fx_px * p.x() / (p.z() * p.z()), 0,
        camera.k.fy_px / p.z(), -camera.k.fy_px * p.y() / (p.z() * p.z());
    const Eigen::RowVector2d by_offset =
        across.transpose() * J * camera.T_camera_world.R * fit.frame.axes.leftCols<2>();
    Eigen::RowVector4d g;
    g << by_offset, s * by_offset;
    return g;
  };
  Eigen::RowVector4d g = row(station_m);
  if (less_station_m) g -= row(*less_station_m);
  return g * fit.covariance * g.transpose();
}

ExpectedLines::ExpectedLines(std::span<const SequenceView> views, const SequenceOptions& options)
    : views_(views), options_(options), joined_(joined_lines_of(views, options.join)) {}

bool ExpectedLines::is_known(int line) const {
  return joined_.lines[static_cast<std::size_t>(line)].views >= options_.other_views;
}

bool ExpectedLines::is_bracketed(int line, int view) const {
  bool before = false, after = false;
  for (const LineSighting& s : joined_.lines[static_cast<std::size_t>(line)].sightings) {
    before = before || (s.view < view && s.view >= view - options_.bracket_views);
    after = after || (s.view > view && s.view <= view + options_.bracket_views);
  }
  return before && after;
}

WorldSighting ExpectedLines::sighting(int view, int segment) const {
  const SequenceView& of = views_[static_cast<std::size_t>(view)];
  WorldSighting s = in_world(of.segments[static_cast<std::size_t>(segment)].in_space,
                             of.T_world_camera, options_.join);
  constexpr double least_m = 1e-5;  // so that none is singular
  s.covariance_m2.diagonal().array() += least_m * least_m;
  s.view = view;
  s.segment = segment;
  return s;
}

std::optional<KnownLine> ExpectedLines::without(int line, int view, double near_m) const {
  std::vector<WorldSighting> others;
  std::set<int> of_views;
  for (const LineSighting& s : joined_.lines[static_cast<std::size_t>(line)].sightings) {
    if (s.view == view) continue;
    others.push_back(sighting(s.view, s.segment));
    of_views.insert(s.view);
  }
  if (static_cast<int>(of_views.size()) < options_.other_views) return {};
  std::vector<const WorldSighting*> members;
  members.reserve(others.size());
  for (const WorldSighting& s : others) members.push_back(&s);
  KnownLine known{fitted(members), {}};
  std::vector<std::pair<double, double>> intervals;
  for (const WorldSighting& s : others) {
    intervals.push_back(
        std::minmax({known.fit.frame.station(s.a_m), known.fit.frame.station(s.b_m)}));
  }
  known.seen_m = stretches(intervals, options_.other_views, near_m);
  if (known.seen_m.empty()) return {};
  return known;
}

double station_of_ray(const Vector3d& origin_m,
                      const Vector3d& direction,
                      const Vector3d& eye_m,
                      const Vector3d& ray) {
  const Vector3d d = origin_m - eye_m, r = ray.normalized();
  const double c = direction.dot(r);
  return (c * r.dot(d) - direction.dot(d)) / (1 - c * c);
}

PlacedCamera placed_camera(const Camera& camera, const Pose& T_world_camera) {
  if (!std::holds_alternative<Pinhole>(camera.model)) {
    throw Error("camera \"" + camera.name + "\"", "has a lens with distortion",
                "give undistorted images and their pinhole camera");
  }
  return {vernier::internal::opencv_intrinsics(camera), camera.size_px, T_world_camera.inverse()};
}

}  // namespace vernier::sim::internal
