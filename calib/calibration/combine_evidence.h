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

/// Evidence of one input, its knowledge of the rig as a prior where it has no other.
JointEvidence evidence_of(const CombineInput& input);

/// That of all inputs, without priors that are another input's calibration: they are among the
/// inputs themselves.
std::vector<JointEvidence> evidence_of_all(const std::vector<CombineInput>& inputs);

/// The priors of `more` that are not among `so_far`.
std::vector<GaussianRigPrior> new_priors(const std::vector<GaussianRigPrior>& so_far,
                                         const std::vector<GaussianRigPrior>& more);

/// With the parameters that no input may move: those that the first does not know.
JointOptions with_held(JointOptions options, const CombineInput& first);

}  // namespace vernier::internal
