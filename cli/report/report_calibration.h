// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calib/rig_estimate.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// Whether to run the cross-validation of models and boards, which calibrates many times.
enum class Validation { make, skip };

/// One rig for the report page: parameters, covariance, and calibration details from its evidence.
/// Without evidence, "missing" gives the reason.
Json report_rig(const RigEstimate& estimate,
                const std::string& file,
                Validation proof,
                const Session& session);

/// Parts derived from the evidence. Corners and residuals, one entry per camera.
Json report_corners(const RigEstimate& estimate);
/// Maps and summary values of the projection uncertainty, one entry per camera.
Json report_projection(const RigEstimate& estimate);
/// Influence of each frame on the estimate.
Json report_views(const RigEstimate& estimate);
/// Cross-validation: richer lens models on held-out views, lengths on held-out boards; notes give
/// the reason for missing parts. `usual`: the same corners without random effects.
Json report_validation(const RigEstimate& estimate,
                       const RigEstimate& usual,
                       const std::string& file,
                       const Session& session);

}  // namespace vernier::cli
