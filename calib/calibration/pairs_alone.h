// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "calib/joint_calibration.h"
#include "calib/pair_observations.h"
#include "calib/rig_prior.h"

namespace vernier::internal {

/// The rig that a set of pairs wants itself, under what was known before, loosened.
struct PairsAlone {
  JointCalibration joint;
  std::size_t pairs = 0;
  double wider = 1;  ///< the prior's standard deviations were multiplied by this

  std::size_t outliers() const { return joint.estimate.calibration->pair_outliers.size(); }
  double left_out_share() const {
    return static_cast<double>(outliers()) / static_cast<double>(pairs);
  }
};

/// What of a rig may differ from what was known before.
enum class Loosened {
  all,   ///< C becomes k² C
  poses  ///< C becomes C + (k² − 1) E C E, with E on the poses of the cameras: those have moved
};

GaussianRigPrior loosened(const GaussianRigPrior& known, double wider, Loosened what);

/// Solved under a ten times wider prior, so that a wrong one does not bias the rig. Where it is
/// still so much surer than the pairs that it makes outliers or noise of them, under one that
/// hardly holds them; under the prior itself where they do not determine the rig otherwise. Throws
/// Error as calibrate_jointly.
PairsAlone pairs_alone(const PairObservations& pairs,
                       const GaussianRigPrior& before,
                       const JointOptions& options,
                       Loosened what = Loosened::all);

}  // namespace vernier::internal
