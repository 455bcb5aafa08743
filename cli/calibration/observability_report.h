// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calib/joint_calibration.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// What matched pairs brought to a rig beyond what was known before them, in words and figures: the
/// spectrum, the scale, vertical disparity and depth before and after.
struct ObservabilityReport {
  std::string text;
  Json json;
};
ObservabilityReport report_observability(const JointCalibration& joint,
                                         const Eigen::MatrixXd& covariance_before);

}  // namespace vernier::cli
