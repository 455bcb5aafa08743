// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calib/rig_estimate.h"
#include "cli/program/session.h"
#include "cli/simulation/plan_result.h"

namespace vernier::cli {

/// A calibrated rig whose file has lost its views, as that of two of its cameras, is planned from
/// nothing.
void warn_of_lost_views(const RigEstimate& rig, const std::string& name, Session& session);

/// Why a plan is not to be trusted.
void warn_of_doubtful_plan(const PlanResult& plan, Session& session);

}  // namespace vernier::cli
