// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/plan_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "calib/board_observations.h"
#include "calib/planning/views_needed.h"
#include "calib/rig_estimate.h"
#include "cli/program/session.h"
#include "cli/simulation/plan_result.h"
#include "sim/study/success_curve.h"

namespace vernier::cli {

void warn_of_lost_views(const RigEstimate& rig, const std::string& name, Session& session) {
  const bool has_views = rig.evidence && !rig.evidence->observations.views.empty();
  if (has_views || !rig.calibration || rig.calibration->views == 0) return;
  if (rig.evidence && rig.evidence->pairs.size() > 0) {
    session.warn(
        fmt::format("{}: it was calibrated from matched corners: they do not count, and board, "
                    "distance and noise are those of a datasheet; say how the board is seen with "
                    "--board, --square-m, --board-distance-m and --pixel-sigma",
                    name));
    return;
  }
  session.warn(fmt::format(
      "{}: its {} views are not in this file, as after convert: they do not count, and board, "
      "distance and noise are those of a datasheet; to count them plan from the file that has "
      "them, of all cameras, with --cameras, or say how the board is seen with --board, "
      "--square-m, "
      "--board-distance-m and --pixel-sigma",
      name, rig.calibration->views));
}

namespace {

constexpr double wide = 1.5;  ///< views allowed by one end of the scale over those by the other

/// What to do about too few trials, with their number where it can be told: what they leave open
/// shrinks with its square root.
std::string more_trials(const PlanResult& plan) {
  constexpr double most = 1e6;
  double times = 0;
  if (plan.scale && plan.scale->low > 0) {
    const double open = 2 * std::log(plan.scale->high / plan.scale->low);
    times = std::pow(open / std::log(wide), 2);
  } else if (!plan.successes.empty()) {
    const SuccessAt& best = plan.successes[0];
    const double margin = best.success - plan.target.value;
    const double open =
        margin > 0 ? best.success - best.interval_95.low : best.interval_95.high - best.success;
    times = std::pow(open / margin, 2);
  }
  const double wanted = times * plan.trials;
  if (!(times > 1) || !(wanted <= most)) return "give more --trials";
  const double unit = std::pow(10, std::max(0.0, std::floor(std::log10(wanted)) - 1));
  return fmt::format("give more --trials, of the order of {:.0f}", unit * std::ceil(wanted / unit));
}

}  // namespace

void warn_of_doubtful_plan(const PlanResult& plan, Session& session) {
  constexpr double unsure = 2, unknown = 4;  // upper over lower end of the interval of views
  constexpr double correlated = 1.5;
  constexpr int few = 13;
  constexpr double shared = 1.25, mostly_shared = 1.5;  // stated over planned, with views so far
  if (plan.leaves_views_out) {
    session.warn(
        "the calibration's own views do not count, as --board makes it a datasheet: leave --board "
        "out to plan from them");
  }
  const double more = plan.curve.empty() ? 1 : plan.stated_sd / plan.curve[0].sd;
  if (more > shared) {
    const std::string text = fmt::format(
        "by the calibration's covariance the standard deviation is now {:.3g} {}, {:.2g} times "
        "what noise and scatter of its views leave: the rest may be of all views (a lens model "
        "that does "
        "not fit, the board), which more of them do not reduce; check the calibration",
        plan.stated_sd, plan.target.quantity == "projection" ? "px" : "m", more);
    if (more > mostly_shared) {
      session.add_trust_warning(text);
    } else {
      session.warn(text);
    }
  }
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
        "whether the target can be reached at all is not clear from so few trials; " +
        more_trials(plan));
    return;
  }
  const ViewsNeeded& needed = *plan.needed;
  // Views go with the inverse square of the scale.
  const bool by_trials =
      plan.scale && std::pow(plan.scale->high / plan.scale->low, 2) > wide;  // also if low is 0
  if (!std::isfinite(needed.interval.high)) {
    session.add_trust_warning(
        "the number of views has no upper end, for the trials leave open whether the target can be "
        "reached: " +
        more_trials(plan));
  } else if (const double width = needed.interval.high / needed.interval.low; width > unsure) {
    const std::string doubt = fmt::format(
        "the number of views is known to a factor of {:.2g} only: {}{}", width,
        by_trials ? more_trials(plan) + ", or " : "",
        plan.from_calibration ? "take some more views and plan again"
                              : "calibrate from five views or more and plan from these");
    if (width > unknown) {
      session.add_trust_warning(doubt);
    } else {
      session.warn(doubt);
    }
  }
}

}  // namespace vernier::cli
