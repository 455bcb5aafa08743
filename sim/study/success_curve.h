// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calib/covariance.h"
#include "calib/interval.h"
#include "calib/rig.h"
#include "sim/experiment.h"
#include "sim/visibility.h"

namespace vernier::sim::internal {

/// How often localisation succeeds at one scale of the calibration error.
struct SuccessAt {
  double psi_c = 0;
  double success = 0;
  Interval interval_95{0, 1};  ///< clustered by recorded map (success_interval.h)
};

struct SuccessCurveOptions {
  std::vector<double> psi_c{0, 0.25, 0.5, 1, 2, 4};  ///< ascending
  int trials = 300;                                  ///< at each scale, in six maps or more
  int threads = 0;                                   ///< 0: all cores
  std::function<void(int done, int total)> progress = {};
};

/// Success against psi_c, which scales the error of a true rig by its covariance. Trials are the
/// same at all scales (queries, image errors, the direction of the error in the rig), so
/// differences are paired. The result does not depend on the number of threads. Throws Error as
/// LocalisationExperiment.
std::vector<SuccessAt> success_curve(const Visibility& visibility,
                                     const Rig& truth,
                                     const Covariance& covariance,
                                     const ExperimentSettings& settings,
                                     const SuccessCurveOptions& options = {});

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
  std::string name;  ///< such as "lateral_shift_px"
  double success = 0;
};

/// Each source of error off in turn, calibration too; the most limiting cause first.
std::vector<LimitingCause> limiting_causes(const Visibility& visibility,
                                           const Rig& truth,
                                           const Covariance& covariance,
                                           const ExperimentSettings& settings,
                                           SuccessCurveOptions options);

}  // namespace vernier::sim::internal
