// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "localise/methods/line_localiser.h"
#include "localise/place.h"
#include "localise/place/space_lines.h"
#include "localise/posterior/pose_posterior.h"
#include "localise/verification/floor_plan_votes.h"
#include "localise/verification/image_lines.h"
#include "localise/verification/place_evidence.h"
#include "localise/verification/view_agreement.h"

namespace vernier::localise::internal {

/// A pose of the first look, turned as another look is.
inline Pose2D turned(const Pose2D& first, double turn_rad) {
  return {first.x_m, first.y_m, first.heading_rad + turn_rad};
}

/// Poses that were tried. One that is close to another is taken for it.
class TriedPoses {
 public:
  TriedPoses(double distance_m, double heading_rad)
      : distance_m_(distance_m), heading_rad_(heading_rad) {}

  /// False if one of them is close.
  bool add(const Pose2D& pose) {
    const auto is_close = [&](const Pose2D& other) {
      return is_close_to(other, pose, distance_m_, heading_rad_);
    };
    if (std::any_of(tried_.begin(), tried_.end(), is_close)) return false;
    tried_.push_back(pose);
    return true;
  }
  void clear() { tried_.clear(); }

 private:
  double distance_m_, heading_rad_;
  std::vector<Pose2D> tried_;
};

/// An order of poses as keys.
struct PoseOrder {
  bool operator()(const Pose2D& a, const Pose2D& b) const {
    return std::tie(a.x_m, a.y_m, a.heading_rad) < std::tie(b.x_m, b.y_m, b.heading_rad);
  }
};

/// What each look says of a pose of the first, line by line, and what tells others from it.
struct LineLocaliser::JudgedPose {
  std::vector<PlaceEvidence> of_looks;
  std::map<Pose2D, Evidence, PoseOrder> from;
};

/// A view that the map recorded, and what it says of where it was taken, by the map without it.
struct LineLocaliser::RecordedView {
  ComparedView view;
  std::optional<PlaceEvidence> at_own;
};

/// Memory and intermediate results of one query.
struct LineLocaliser::Query {
  std::vector<Seen> looks;
  std::vector<Hypothesis> found, compared;              // of the first look's pose
  std::map<int, SpaceLines> merged;                     // of nodes, as they are needed
  std::map<int, std::vector<PlanUpright>> uprights;     // of these
  TriedPoses started{0.12, 0.05}, finals{0.15, 0.1};    // from which poses were refined, compared
  TriedPoses doubted{0.5, 0.2};                         // whose rivals were compared
  float leader = std::numeric_limits<float>::lowest();  // of the scores there
  PredictedLines room;
  std::map<Pose2D, JudgedPose, PoseOrder> judged;
  std::map<int, RecordedView> recorded;  // of nodes, as they are needed
};

}  // namespace vernier::localise::internal
