// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/calibration/change_findings.h"
#include "calib/calibration/joint_minimum.h"
#include "calib/joint_calibration.h"
#include "calib/pair_observations.h"
#include "calib/rig_estimate.h"
#include "calib/solver/normal_equations.h"

namespace vernier::internal {

/// What is said of a joint calibration: `plain` are the equations of the inliers in the free
/// directions, with priors, and `bound` is the inverse of their information.
CalibrationSummary summary_of(const JointMinimum& joint,
                              const JointEvidence& evidence,
                              const PairObservations& inliers,
                              const ReducedNormalEquations& plain,
                              const Eigen::MatrixXd& bound);

/// Adds warnings about the result. A doubtful change between image pairs
/// (calib/calibration/change_findings.h) stands for what follows from it: large residuals, and many
/// outliers.
void warn(const JointCalibration& joint,
          const JointEvidence& evidence,
          const std::optional<PairChange>& change,
          const JointOptions& options,
          CalibrationSummary& summary);

}  // namespace vernier::internal
