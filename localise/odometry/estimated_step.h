// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calib/rig.h"
#include "localise/odometry.h"
#include "localise/odometry/step_refinement.h"
#include "localise/place.h"

namespace vernier::localise::internal {

struct EstimatedStep {
  MotionStep step;
  std::vector<CornerInfluence> influences;  ///< one per inlier
};

/// estimate_step() with what each corner contributes to the covariance.
std::optional<EstimatedStep> estimated_step(const Rig& rig,
                                            std::span<const StereoCorner> from,
                                            std::span<const StereoCorner> to,
                                            std::span<const CornerLink> links,
                                            const StepOptions& options);

}  // namespace vernier::localise::internal
