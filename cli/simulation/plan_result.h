// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "calib/planning/views_needed.h"
#include "cli/program/session.h"
#include "sim/study/success_curve.h"

namespace vernier::cli {

/// What a plan aims at.
struct PlanTarget {
  std::string quantity;  ///< depth, projection or success
  double value = 0, at_m = 5;
  std::string unit;       ///< m, px or none
  std::string condition;  ///< of a success: "within 0.1 m", "depth error at most 0.05 m"
  double success_error = std::numeric_limits<double>::quiet_NaN();  ///< the same as a number
};

/// What `plan` found.
struct PlanResult {
  PlanTarget target;
  std::string basis;  ///< in words: the calibration or datasheet
  bool from_calibration = false;
  bool leaves_views_out = false;  ///< a calibration's, because a board was given
  ViewKnowledge known;
  /// Part of the target that calibration may have, of a standard deviation; for success that of
  /// the depth at which the rate is met. Empty if the rest alone exceeds the target.
  std::optional<double> sd_allowed;
  /// Of the depth of one match, without any error of the calibration; not a number if unknown.
  double pixel_noise_sd = std::numeric_limits<double>::quiet_NaN();
  double pair_sigma_px = 0;  ///< included in the target if above 0
  std::optional<ViewsNeeded> needed;
  /// If all cameras are to see every further view; only where some so far are seen by few.
  std::optional<ViewsNeeded> needed_by_all;
  std::vector<SdAfter> curve;
  std::vector<SuccessAt> successes;  ///< of a success rate
  int trials = 0;                    ///< of each of them
  std::optional<ScaleNeeded> scale;
  double reference_sd_m = 0;  ///< of the depth at once the error that `successes` scale
  /// By the calibration's own covariance, of the quantity of `curve`; not a number if not known.
  double stated_sd = std::numeric_limits<double>::quiet_NaN();
  std::vector<LimitingCause> causes;  ///< if no calibration is good enough
  std::string limit;                  ///< why it cannot be reached, and what limits; else empty

  /// Nothing if the trials leave open whether the target can be reached.
  std::optional<bool> is_reachable() const {
    if (!limit.empty()) return false;
    return needed ? std::optional(true) : std::nullopt;
  }
};

/// "202 views, 143 to 286 with 95 % confidence, if all cameras see the board in the further ones"
std::string by_all_text(const ViewsNeeded& needed);

/// Whether some cameras, of those that were chosen, did not see the board in some frames so far.
bool has_partial_frames(const ViewKnowledge& known);

/// " (6 of 36 are seen by all cameras)"; empty if all are.
std::string partial_frames_text(const ViewKnowledge& known);

Json plan_json(const PlanResult& plan);
std::string plan_text(const PlanResult& plan);

}  // namespace vernier::cli
