// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calib/rig_estimate.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// Whether models are compared and boards left out for the page, which calibrates many times.
enum class Validation { make, skip };

/// One rig for the report's page: parameters, covariance, and all that its evidence shows of the
/// calibration. Where there is no evidence, "missing" says so.
Json report_rig(const RigEstimate& estimate,
                const std::string& file,
                Validation proof,
                const Session& session);

/// Its parts, from the evidence. Corners and residuals, a list a camera.
Json report_corners(const RigEstimate& estimate);
/// Maps of the projection uncertainty, a list a camera, and its figures in numbers.
Json report_projection(const RigEstimate& estimate);
/// What each frame did to the estimate.
Json report_views(const RigEstimate& estimate);
/// Richer lens models on views left out, and lengths on boards left out; notes say why one is
/// missing.
Json report_validation(const RigEstimate& estimate,
                       const std::string& file,
                       const Session& session);

}  // namespace vernier::cli
