// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calib/joint_calibration.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// Information gained from matched pairs relative to the prior, as text and JSON: spectrum, scale,
/// vertical disparity and depth before and after.
struct ObservabilityReport {
  std::string text;
  std::string warning;  ///< of a rig that sees nothing near by with both cameras; empty: none
  Json json;
};
ObservabilityReport report_observability(const JointCalibration& joint,
                                         const Eigen::MatrixXd& covariance_before);

}  // namespace vernier::cli
