// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "localise/place.h"
#include "localise/place/space_lines.h"

namespace vernier::localise::internal {

/// A vertical line on the floor plan of a robot frame.
struct PlanUpright {
  float x_m = 0, y_m = 0;
  float low_m = 0, high_m = 0;
  float sigma_m = 0;
};
std::vector<PlanUpright> plan_uprights(std::span<const PlaceLine> lines);
std::vector<PlanUpright> plan_uprights(const SpaceLines& lines);

/// Vertical lines may be parts of one that share so much of the shorter one's height.
inline constexpr float least_common_height = 0.3f;
bool heights_agree(const PlanUpright& a, const PlanUpright& b);

struct VoteOptions {
  double turn_step_rad = 0.0436;  ///< 2.5 degrees
  int turn_steps = 4;             ///< to either side of the given heading
  double span_m = 0.6;            ///< along each axis, to either side
  double cell_m = 0.1;
  int peaks = 3;  ///< at most
};

struct VotePeak {
  Pose2D query_in_node;
  float votes = 0;
};

/// The rigid motions that bring the most vertical lines of a query onto a node's, best first: a
/// Hough vote over rotations and translations around a pose (generalised Hough transform,
/// Ashbrook et al. 1995). Peaks are at least 0.25 m or two turns apart. Empty without votes.
std::vector<VotePeak> vote(std::span<const PlanUpright> query,
                           std::span<const PlanUpright> node,
                           const Pose2D& around,
                           const VoteOptions& options = {});

}  // namespace vernier::localise::internal
