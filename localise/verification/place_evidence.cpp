// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/verification/place_evidence.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "localise/place.h"
#include "localise/place/space_lines.h"
#include "localise/place/view_camera.h"
#include "localise/verification/image_lines.h"
#include "localise/verification/view_agreement.h"

namespace vernier::localise::internal {

namespace {

std::array<ImageLines*, 2> sets(PredictedLines& lines) { return {&lines.steep, &lines.flat}; }

/// A point of an image as a place sees it, in the map's frame, m.
Eigen::Vector3f in_map(const Eigen::Vector3f& uvw, const ViewCamera& camera, const Pose2D& pose) {
  const Eigen::Vector3f robot = unproject(camera, uvw);
  const Pose2D floor = compose(pose, {robot.x(), robot.y(), 0});
  return {static_cast<float>(floor.x_m), static_cast<float>(floor.y_m), robot.z()};
}

/// Whether a line of one place and its partner at another are where one line of the world is.
bool are_one(const ImageLines& lines,
             int line,
             const Pose2D& pose,
             const ImageLines& others,
             int other,
             const Pose2D& pose_of_others,
             const ViewCamera& camera) {
  constexpr float aside_m = 0.15f, sigmas = 0.5f, beyond_m = 0.5f;  // of its ends as they are seen
  const QueryLine middle = as_query_line(lines, line);
  const Eigen::Vector3f m = in_map({middle.u, middle.v, middle.w}, camera, pose);
  const float length = others.length_px[other];
  const Eigen::Vector3f begin(others.u[other], others.v[other], others.w[other]);
  const Eigen::Vector3f by(length * others.dx[other], length * others.dy[other], others.dw[other]);
  const Eigen::Vector3f a = in_map(begin, camera, pose_of_others);
  const Eigen::Vector3f b = in_map(begin + by, camera, pose_of_others);
  const Eigen::Vector3f along = (b - a).normalized();
  const float at = (m - a).dot(along);
  if (!(at > -beyond_m && at < (b - a).norm() + beyond_m)) return false;
  const Eigen::Vector3f across = (m - a) - at * along;
  const float sigma = std::sqrt(middle.variance_m2) + std::sqrt(others.variance_m2[other]);
  return across.norm() < aside_m + sigmas * sigma;
}

/// What the map holds at the other of two places for a line of one.
struct Counterpart {
  int line = -1;        ///< the best one of the same class; -1: nothing like it
  bool is_one = false;  ///< it is the line itself, seen from the other place
};
/// Of the steep and flat lines.
using Counterparts = std::array<std::vector<Counterpart>, 2>;

Counterparts counterparts(PlacePrediction& place,
                          PlacePrediction& other_place,
                          const ViewCamera& camera,
                          const AgreementOptions& options) {
  Counterparts result;
  for (std::size_t set = 0; set < 2; ++set) {
    const ImageLines& own = *sets(place.lines)[set];
    ImageLines& others = *sets(other_place.lines)[set];
    result[set].reserve(own.size);
    for (int i = 0; i < own.size; ++i) {
      const int line = best_match(as_query_line(own, i), others, camera, options.tolerance).line;
      const bool is_one = line >= 0 && are_one(own, i, place.pose_in_map, others, line,
                                               other_place.pose_in_map, camera);
      result[set].push_back({line, is_one});
    }
  }
  return result;
}

}  // namespace

PlaceEvidence place_evidence(const ComparedView& view,
                             const SpaceLines& lines,
                             const Pose2D& pose,
                             const Pose2D& pose_in_map,
                             const AgreementOptions& options) {
  PlaceEvidence evidence;
  evidence.predicted.pose_in_map = pose_in_map;
  PredictedLines& recorded = evidence.predicted.lines;
  predict(lines, pose, view.camera, recorded);
  evidence.seen.reserve(view.lines.size());
  for (const QueryLine& query : view.lines) {
    ImageLines& partners = query.steep ? recorded.steep : recorded.flat;
    const LineMatch match = best_match(query, partners, view.camera, options.tolerance);
    evidence.seen.push_back({likelihood(match, options), match.line});
  }
  for (std::size_t set = 0; set < 2; ++set) {
    const ImageLines& predicted = *sets(recorded)[set];
    for (int i = 0; i < predicted.size; ++i) {
      evidence.missed[set].push_back(missed(predicted, i, view.camera));
    }
  }
  return evidence;
}

PlaceDifference difference_between(const ComparedView& view,
                                   PlaceEvidence& a,
                                   PlaceEvidence& b,
                                   const AgreementOptions& options) {
  const Counterparts of_a = counterparts(a.predicted, b.predicted, view.camera, options);
  const Counterparts of_b = counterparts(b.predicted, a.predicted, view.camera, options);
  PlaceDifference difference;
  const auto add = [&](double nats, bool is_one) {
    (is_one ? difference.by_one_recording : difference.by_two_recordings) += nats;
    if (!is_one) difference.variance += nats * nats;
  };
  for (std::size_t i = 0; i < view.lines.size(); ++i) {
    const auto &at_a = a.seen[i], &at_b = b.seen[i];
    const bool is_of_a = at_a.likelihood >= at_b.likelihood;
    const int partner = is_of_a ? at_a.partner : at_b.partner;
    if (partner < 0) continue;  // background at both
    add(observations(view.lines[i].length_px) * std::log(at_a.likelihood / at_b.likelihood),
        (is_of_a ? of_a : of_b)[view.lines[i].steep ? 0 : 1][partner].is_one);
  }
  // A line that the view lacks is missing at both places if both have it.
  const double per_observation = std::log(options.missing);
  for (std::size_t set = 0; set < 2; ++set) {
    std::vector<float> left = b.missed[set];
    for (std::size_t i = 0; i < of_a[set].size(); ++i) {
      float missed = a.missed[set][i];
      if (const int partner = of_a[set][i].line; partner >= 0) {
        missed -= std::exchange(left[partner], 0.0f);
      }
      add(missed * per_observation, of_a[set][i].is_one);
    }
    for (std::size_t i = 0; i < left.size(); ++i) {
      add(-left[i] * per_observation, of_b[set][i].is_one);
    }
  }
  return difference;
}

}  // namespace vernier::localise::internal
