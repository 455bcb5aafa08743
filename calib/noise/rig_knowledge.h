// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"

namespace vernier::internal {

/// What is known of the rig's free directions z besides the corners: the cost zᵀ P z + 2 pᵀ z +
/// constant. Empty: nothing.
struct RigKnowledge {
  Eigen::MatrixXd information;  ///< P
  Eigen::VectorXd score;        ///< p
};

/// That of priors at `rig`, in the directions E, the first of `unknowns`; empty without priors.
RigKnowledge knowledge_of_priors(const std::vector<RigPrior>& priors,
                                 const Rig& rig,
                                 const Eigen::MatrixXd& E,
                                 Eigen::Index unknowns);

/// The priors of a calibration, at its rig. It must have evidence.
std::vector<RigPrior> priors_of(const RigEstimate& estimate);

}  // namespace vernier::internal
