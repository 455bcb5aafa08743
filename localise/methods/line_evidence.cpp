// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Of LineLocaliser: what tells two poses of a map apart that may be equal places.
#include <algorithm>
#include <cstddef>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "localise/map/merged_lines.h"
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

/// What a view says of the best pose near one, by the map without one of its nodes. Nothing if the
/// map holds nothing else there.
std::optional<PlaceEvidence> LineLocaliser::evidence_without(int left_out,
                                                             const ComparedView& view,
                                                             const Pose2D& pose,
                                                             Query& query) const {
  constexpr int steps = 2;  // from a pose that is known as well as that of the query
  const int node = grid_.nearest(pose, left_out);
  if (node < 0) return {};
  const Pose2D& of_node = map_.nodes[node].pose;
  const SpaceLines lines = merged_lines(map_, grid_, node, left_out);
  const Pose2D best =
      improve(view, lines, relative(pose, of_node), steps, fine_agreement(), query.room).pose;
  return place_evidence(view, lines, best, compose(of_node, best), fine_agreement());
}

/// The nodes whose views are taken for looks from the place of a pose of the first look.
std::set<int> LineLocaliser::nodes_of_place(const Pose2D& pose, const Query& query) const {
  constexpr double near_m = 1, near_rad = 0.6;  // success, and half of what a camera sees
  constexpr std::size_t most = 8;  // of a look: more say little more, for they are not independent
  std::set<int> of_all;
  for (const Seen& look : query.looks) {
    std::vector<int> nodes = grid_.near(turned(pose, look.turn_rad), near_m, near_rad);
    std::stable_sort(nodes.begin(), nodes.end(), [&](int i, int j) {
      return distance_m(map_.nodes[i].pose, pose) < distance_m(map_.nodes[j].pose, pose);
    });
    if (nodes.size() > most) nodes.resize(most);
    of_all.insert(nodes.begin(), nodes.end());
  }
  return of_all;
}

/// What tells one place from another in the views that the map recorded near it in the directions
/// of the looks: each is compared with the other recordings there and, at the same pose beside the
/// other place, with those of that, without the nearest one.
RecordedDifference LineLocaliser::recorded_difference(const Pose2D& here,
                                                      const Pose2D& there,
                                                      Query& query) const {
  RecordedDifference sum;
  for (const int node : nodes_of_place(here, query)) {
    const Pose2D& own = map_.nodes[node].pose;
    const Pose2D other = compose(there, relative(own, here));
    if (!query.recorded.contains(node)) {
      const ComparedView seen = compared_view(map_.nodes[node].view);
      query.recorded[node] = {seen, evidence_without(node, seen, own, query)};
    }
    auto& [view, at_own] = query.recorded[node];
    auto at_other = evidence_without(grid_.nearest(other), view, other, query);
    if (!at_own || !at_other) continue;
    const PlaceDifference difference =
        difference_between(view, *at_own, *at_other, fine_agreement());
    sum.nats += difference.by_two_recordings;
    sum.variance += difference.variance;
    ++sum.views;
  }
  return sum;
}

/// What all looks together tell one pose from another by.
Evidence LineLocaliser::evidence(const Hypothesis& a, const Hypothesis& b, Query& query) const {
  constexpr double hopeless_nats = 100;
  Evidence sum{a.score - b.score, 0, 0, 0};
  if (sum.certain > hopeless_nats) return sum;
  JudgedPose &at_a = judged(a.pose, query), &at_b = judged(b.pose, query);
  const auto known = at_b.from.find(a.pose);
  if (known != at_b.from.end()) return known->second;
  for (std::size_t i = 0; i < query.looks.size(); ++i) {
    const PlaceDifference difference = difference_between(query.looks[i].view, at_a.of_looks[i],
                                                          at_b.of_looks[i], fine_agreement());
    sum.certain -= difference.by_two_recordings;
    sum.doubtful += difference.by_two_recordings;
    sum.variance += difference.variance;
  }
  const RecordedDifference recorded = of_both(recorded_difference(a.pose, b.pose, query),
                                              recorded_difference(b.pose, a.pose, query));
  sum.repeated = probability_equal(options_.repeats, recorded);
  return at_b.from[a.pose] = sum;
}

}  // namespace vernier::localise::internal
