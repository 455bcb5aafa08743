// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "calib/covariance.h"
#include "calib/rig_estimate.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// Calibration summary, all parameters with their standard deviations, and a description of the
/// principal directions of the scaled covariance.
std::string rig_table(const RigEstimate& estimate);
Json rig_json(const RigEstimate& estimate);

/// The components of the random effects, 0 where not estimated.
Json effects_json(const CalibrationEffects& effects);
Json aspect_json(const AspectEstimate& aspect);

/// Describes the first principal directions, one per line, with their fraction of the scaled
/// variance.
std::string direction_lines(const ScaledDecomposition& decomposition, std::size_t most = 5);

}  // namespace vernier::cli
