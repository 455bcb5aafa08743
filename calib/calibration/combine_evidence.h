// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calib/combine.h"
#include "calib/joint_calibration.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"

namespace vernier::internal {

/// Whether a calibration holds views of a board, or matched pairs.
bool has_boards(const RigEstimate& estimate);
bool has_pairs(const RigEstimate& estimate);

/// Evidence of one input; the rig's estimate as a prior if it has no other.
JointEvidence evidence_of(const CombineInput& input);

/// Evidence of the inputs, without priors that are the calibration of another input.
std::vector<JointEvidence> evidence_of_all(const std::vector<CombineInput>& inputs);

/// The priors of `more` that are not among `so_far`.
std::vector<GaussianRigPrior> new_priors(const std::vector<GaussianRigPrior>& so_far,
                                         const std::vector<GaussianRigPrior>& more);

/// Adds the parameters that no input may change: those without variance in the first.
JointOptions with_held(JointOptions options, const CombineInput& first);

}  // namespace vernier::internal
