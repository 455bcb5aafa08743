// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/joined_lines.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstddef>
#include <utility>

#include "calib/base/all_within.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "localise/join/line_association.h"
#include "localise/join/line_fit.h"
#include "localise/join/line_reach.h"

namespace vernier::localise {

using namespace internal;

namespace {

void check(const JoinOptions& o) {
  const auto refuse_unless = [](bool good, const char* what) {
    if (!good) throw Error("options of the join", what, "see localise/joined_lines.h");
  };
  refuse_unless(o.gate > 0, "have a gate that is not above 0");
  refuse_unless(o.max_offset_m > 1e-4 && o.max_offset_m < 1e3,
                "have a largest offset that is not between 0.1 mm and 1 km");
  refuse_unless(o.max_turn_rad > 0 && o.max_turn_rad < 1.5,
                "have a largest angle that is not between 0 and 1.5 rad");
  refuse_unless(o.max_gap_m >= 0 && o.max_sigma_m > 0, "have a gap or a largest error below 0");
  refuse_unless(o.view_position_m >= 0 && o.view_turn_rad >= 0 && o.shared_m >= 0,
                "have errors below 0");
}

void check(const SightedSegment& s, const Pose& T_world_camera, std::size_t view, std::size_t i) {
  const std::string place = fmt::format("segment {} of view {}", i, view);
  constexpr double most_m = 1e4;
  if (!vernier::internal::all_within(s.a_m, most_m) ||
      !vernier::internal::all_within(s.b_m, most_m) ||
      !vernier::internal::all_within(T_world_camera.t, most_m) || !T_world_camera.R.allFinite()) {
    throw Error(place, "is not within 10 km, or its view's pose is not", "correct it");
  }
  if (!((s.b_m - s.a_m).norm() > 1e-6)) {
    throw Error(place, "has no length", "leave it out");
  }
  const bool finite = vernier::internal::all_within(s.covariance_m2, 1e8);
  const auto skew = [&] { return (s.covariance_m2 - s.covariance_m2.transpose()).norm(); };
  if (!finite || skew() > 1e-6 * s.covariance_m2.norm()) {
    throw Error(place, "has a covariance that is not finite or not symmetric", "correct it");
  }
  if (!is_semidefinite(s.covariance_m2)) {
    throw Error(place, "has a covariance that is not positive semidefinite", "correct it");
  }
}

JoinedLine joined(const GrowingLine& line,
                  std::span<const WorldSighting> all,
                  const JoinOptions& options) {
  std::vector<const WorldSighting*> members;
  for (const int i : line.members) members.push_back(&all[i]);
  const LineFrame& frame = line.fit.frame;
  const LineReach ends = reach(members, frame);
  const Eigen::Vector3d z = frame.axes.col(2);
  const auto along_m2 = [&](std::size_t sighting, int end) -> double {
    return z.dot(members[sighting]->covariance_m2.block<3, 3>(3 * end, 3 * end) * z);
  };
  JoinedLine result;
  result.a_m = frame.origin_m + ends.low_m * z;
  result.b_m = frame.origin_m + ends.high_m * z;
  result.covariance_m2 = covariance_of_ends(
      line.fit, ends.low_m, ends.high_m,
      {along_m2(ends.low_sighting, ends.low_end), along_m2(ends.high_sighting, ends.high_end)});
  result.covariance_m2.diagonal().array() += options.shared_m * options.shared_m;
  for (const WorldSighting* s : members) {
    const LineMeasurement m = measured(*s, frame);
    const auto [low, high] = std::minmax(m.station_m[0], m.station_m[1]);
    result.sightings.push_back(
        {s->view, s->segment, low - ends.low_m, high - ends.low_m, residual2(m)});
    result.chi2 += result.sightings.back().distance2;
    result.views +=
        result.sightings.size() == 1 || result.sightings.end()[-2].view != s->view ? 1 : 0;
  }
  return result;
}

}  // namespace

JoinedLines join_lines(std::span<const SegmentsOfView> views, const JoinOptions& options) {
  check(options);
  JoinedLines result;
  std::vector<WorldSighting> sightings;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto& segments = views[v].segments;
    result.line_of.emplace_back(segments.size(), JoinedLines::none);
    for (std::size_t i = 0; i < segments.size(); ++i) {
      check(segments[i], views[v].T_world_camera, v, i);
      WorldSighting sighting = in_world(segments[i], views[v].T_world_camera, options);
      make_definite(sighting);
      if (sigma_across(sighting) > options.max_sigma_m) continue;
      sighting.view = static_cast<int>(v);
      sighting.segment = static_cast<int>(i);
      sightings.push_back(std::move(sighting));
    }
  }
  for (const GrowingLine& line : LineAssociation(sightings, options).associate()) {
    for (const int i : line.members) {
      result.line_of[sightings[i].view][sightings[i].segment] =
          static_cast<int>(result.lines.size());
    }
    result.lines.push_back(joined(line, sightings, options));
  }
  return result;
}

}  // namespace vernier::localise
