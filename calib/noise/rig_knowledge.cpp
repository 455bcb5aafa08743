// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/rig_knowledge.h"

#include <Eigen/Core>
#include <vector>

#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"

namespace vernier::internal {

RigKnowledge knowledge_of_priors(const std::vector<RigPrior>& priors,
                                 const Rig& rig,
                                 const Eigen::MatrixXd& E,
                                 Eigen::Index unknowns) {
  if (priors.empty()) return {};
  RigKnowledge all{Eigen::MatrixXd::Zero(unknowns, unknowns), Eigen::VectorXd::Zero(unknowns)};
  const Eigen::Index n = E.cols();
  for (const RigPrior& prior : priors) {
    const PriorOffset offset = prior_offset(prior, rig);
    const Eigen::MatrixXd J = offset.by_rig * E;
    all.information.topLeftCorner(n, n) += J.transpose() * prior.information * J;
    all.score.head(n) += J.transpose() * prior.information * offset.delta;
  }
  return all;
}

std::vector<RigPrior> priors_of(const RigEstimate& estimate) {
  std::vector<RigPrior> priors;
  for (const GaussianRigPrior& known : estimate.evidence->priors) {
    priors.push_back(rig_prior(estimate.rig, known));
  }
  return priors;
}

}  // namespace vernier::internal
