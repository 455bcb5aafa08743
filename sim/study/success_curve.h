// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calib/interval.h"
#include "sim/study/study.h"

namespace vernier::sim::internal {

/// How often trials succeed at one scale of the calibration error.
struct SuccessAt {
  double psi_c = 0;
  double success = 0;
  Interval interval_95{0, 1};  ///< clustered by recorded map, or block (success_interval.h)
  int failed = 0;              ///< trials that a program or a source of error spoilt
  std::string why_failed = {};
};

struct SuccessCurveOptions {
  std::vector<double> psi_c{0, 0.25, 0.5, 1, 2, 4};  ///< ascending
  int threads = 0;                                   ///< 0: all cores
  std::function<void(int done, int total)> progress = {};
};

/// Success against psi_c, which scales the error of the true rig by its covariance: the trials of a
/// study's first cell, at each scale in place of its sources.calibration. They are the same at all
/// scales (queries, image errors, the direction of the error in the rig), so differences are
/// paired, and all of them are run. Nothing is stored. The result does not depend on the number of
/// threads. Throws Error as run_study.
std::vector<SuccessAt> success_curve(Study study, const SuccessCurveOptions& options = {});

/// The same with further scales (scales_between), until a rate is met, and its interval's limits
/// are, between two that are a quarter apart at most.
std::vector<SuccessAt> success_curve_about(const Study& study,
                                           double success,
                                           const SuccessCurveOptions& options = {});

/// Where to look next for the scale at which a rate, or a limit of its interval, is met: the
/// geometric mean of the scales beside it, half of the smallest where it is below that (down to
/// 1/64); ascending. Empty where these are a quarter apart, and where the curve does not meet it.
std::vector<double> scales_between(const std::vector<SuccessAt>& curve, double success);

/// The scale at which a success rate is met, of a rate that falls with the scale.
struct ScaleNeeded {
  double psi_c = 0;          ///< 0 if not even no error meets it
  double low = 0, high = 0;  ///< where the limits of the intervals meet it
  bool beyond = false;       ///< met at the largest scale that was tried; psi_c and high are that
};

/// The rate is made monotone by isotonic regression (Barlow et al., "Statistical inference under
/// order restrictions", 1972), the limits by the order itself: an upper limit holds for all larger
/// scales, a lower one for all smaller. Between scales all are interpolated linearly.
ScaleNeeded scale_needed(const std::vector<SuccessAt>& curve, double success);

/// What success without any calibration error would be if one cause were not there.
struct LimitingCause {
  std::string name;  ///< such as "lateral_shift_px"; of one's own its name, or "command"
  double success = 0;
};

/// Each source of error that acts on the study's system off in turn, calibration too; the most
/// limiting cause first. Of the options psi_c does not count.
std::vector<LimitingCause> limiting_causes(Study study, const SuccessCurveOptions& options = {});

}  // namespace vernier::sim::internal
