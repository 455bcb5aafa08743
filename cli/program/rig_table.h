// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "calib/covariance.h"
#include "calib/rig_estimate.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// Calibration figures, every parameter with its standard deviations, and the directions of the
/// scaled covariance in words.
std::string rig_table(const RigEstimate& estimate);
Json rig_json(const RigEstimate& estimate);

/// The first directions in words, one a line, with their share of the scaled variance.
std::string direction_lines(const ScaledDecomposition& decomposition, std::size_t most = 5);

}  // namespace vernier::cli
