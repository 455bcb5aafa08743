// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Of LineLocaliser: what tells two poses of a map apart that may be equal places.
#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

#include "localise/methods/line_localiser.h"
#include "localise/methods/line_query.h"
#include "localise/place.h"
#include "localise/place/space_lines.h"
#include "localise/posterior/pose_posterior.h"
#include "localise/topological_map.h"
#include "localise/verification/image_lines.h"
#include "localise/verification/place_evidence.h"
#include "localise/verification/view_agreement.h"

namespace vernier::localise::internal {

/// A pose with what each look says of it, computed once.
LineLocaliser::JudgedPose& LineLocaliser::judged(const Pose2D& pose, Query& query) const {
  const auto known = query.judged.find(pose);
  if (known != query.judged.end()) return known->second;
  JudgedPose& judged = query.judged[pose];
  for (const Seen& look : query.looks) {
    const Pose2D at = turned(pose, look.turn_rad);
    const MapPart part = map_part(at, query);
    judged.of_looks.push_back(
        place_evidence(look.view, *part.lines, part.pose_in_node, at, fine_agreement()));
  }
  return judged;
}

/// What the map holds around a pose of the first look: in other directions, and a few steps before
/// and behind it; nothing where it holds none. Computed once.
LineLocaliser::Surroundings& LineLocaliser::surroundings(const Pose2D& pose, Query& query) const {
  Surroundings& around = judged(pose, query).around;
  if (!around.empty()) return around;
  constexpr double third = std::numbers::pi / 3;
  const auto look_from = [&](double forward_m, double turn_rad) {
    const Pose2D at = compose(pose, {forward_m, 0, turn_rad});
    const MapPart part = map_part(at, query);
    std::optional<PlacePrediction>& seen = around.emplace_back();
    if (part.node < 0) return;
    seen.emplace().pose_in_map = at;
    predict(*part.lines, part.pose_in_node, query.looks[0].view.camera, seen->lines);
  };
  for (int i = 1; i < 6; ++i) look_from(0, i * third);
  for (const double forward_m : {1.5, -1.5, 3.0, -3.0}) {
    for (const double turn_rad : {0.0, std::numbers::pi}) look_from(forward_m, turn_rad);
  }
  return around;
}

/// How alike the surroundings of two poses are, where the map holds both.
std::vector<LineLikeness> LineLocaliser::likenesses_around(const Pose2D& a,
                                                           const Pose2D& b,
                                                           Query& query) const {
  std::vector<LineLikeness> lines;
  Surroundings &at_a = surroundings(a, query), &at_b = surroundings(b, query);
  for (std::size_t i = 0; i < at_a.size(); ++i) {
    if (!at_a[i] || !at_b[i]) continue;
    const std::vector<LineLikeness> here =
        likenesses_between(*at_a[i], *at_b[i], query.looks[0].view.camera, fine_agreement());
    lines.insert(lines.end(), here.begin(), here.end());
  }
  return lines;
}

/// What all looks together tell one pose from another by.
Evidence LineLocaliser::evidence(const Hypothesis& a, const Hypothesis& b, Query& query) const {
  constexpr double hopeless_nats = 100;
  Evidence sum{a.score - b.score, 0, 0, 0};
  if (sum.certain > hopeless_nats) return sum;
  JudgedPose &at_a = judged(a.pose, query), &at_b = judged(b.pose, query);
  const auto known = at_b.from.find(a.pose);
  if (known != at_b.from.end()) return known->second;
  std::vector<LineLikeness> lines;
  for (std::size_t i = 0; i < query.looks.size(); ++i) {
    const PlaceDifference difference = difference_between(query.looks[i].view, at_a.of_looks[i],
                                                          at_b.of_looks[i], fine_agreement());
    sum.certain -= difference.by_two_recordings;
    sum.doubtful += difference.by_two_recordings;
    sum.variance += difference.variance;
    lines.insert(lines.end(), difference.lines.begin(), difference.lines.end());
  }
  sum.repeated =
      options_.repeats * probability_equal(lines, likenesses_around(a.pose, b.pose, query));
  return at_b.from[a.pose] = sum;
}

}  // namespace vernier::localise::internal
