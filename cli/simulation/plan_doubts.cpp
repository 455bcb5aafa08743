// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/plan_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <string>

#include "calib/board_observations.h"
#include "calib/planning/views_needed.h"
#include "calib/rig_estimate.h"
#include "cli/program/session.h"
#include "cli/simulation/plan_result.h"

namespace vernier::cli {

void warn_of_lost_views(const RigEstimate& rig, const std::string& name, Session& session) {
  const bool has_views = rig.evidence && !rig.evidence->observations.views.empty();
  if (has_views || !rig.calibration || rig.calibration->views == 0) return;
  session.warn(fmt::format(
      "{}: its {} views are not in this file, as after convert: they do not count, and board, "
      "distance and noise are those of a datasheet; calibrate its cameras from their corners "
      "to count them, or say how the board is seen with --board, --square-m, --board-distance-m "
      "and --pixel-sigma",
      name, rig.calibration->views));
}

void warn_of_partial_frames(const PlanResult& plan, const RigEstimate& rig, Session& session) {
  constexpr double few = 0.1;  // of all frames
  if (!plan.from_calibration) return;
  const std::size_t cameras = rig.rig.cameras.size();
  std::map<int, std::size_t> views_of_frame;
  for (const BoardView& view : rig.evidence->observations.views) ++views_of_frame[view.frame];
  const auto partial = static_cast<std::size_t>(
      std::count_if(views_of_frame.begin(), views_of_frame.end(),
                    [&](const auto& frame) { return frame.second < cameras; }));
  const double share = static_cast<double>(partial) / static_cast<double>(views_of_frame.size());
  if (share <= few) return;
  session.warn(fmt::format(
      "{} of {} frames are not seen by all cameras, and further views are planned as if all saw "
      "them: of frames such as so far about {:.1f} times as many more are needed",
      partial, views_of_frame.size(), 1 / (1 - std::min(share, 0.99))));
}

void warn_of_doubtful_plan(const PlanResult& plan, Session& session) {
  constexpr double unsure_below = 0.8;  // confidence of an interval of a factor of two
  constexpr double correlated = 1.5;
  constexpr int few = 13;
  if (plan.from_calibration && plan.known.taken < few && plan.known.inflation > correlated) {
    session.warn(fmt::format(
        "the residuals are correlated over the board, and {} views understate that: on real images "
        "intervals held less often than stated, and more views were needed (docs/plan.md)",
        plan.known.taken));
  }
  if (!plan.limit.empty()) {
    session.add_trust_warning("no number of views reaches the target: " + plan.limit);
    return;
  }
  if (!plan.needed) {
    session.add_trust_warning(
        "whether the target can be reached at all is not clear from so few trials; give more "
        "--trials");
    return;
  }
  const ViewsNeeded& needed = *plan.needed;
  if (needed.interval.high > 2 * needed.interval.low + 1) {
    session.add_trust_warning(
        fmt::format("the number of views is known to {:.0f} to {:.0f} only: give more --trials",
                    needed.interval.low, needed.interval.high));
  } else if (needed.confidence < unsure_below) {
    session.add_trust_warning(fmt::format(
        "the number of views is known to a factor of two with {:.0f} % confidence only: {}",
        100 * needed.confidence,
        plan.from_calibration ? "take some more views and plan again"
                              : "calibrate from five views or more and plan from these"));
  }
}

}  // namespace vernier::cli
