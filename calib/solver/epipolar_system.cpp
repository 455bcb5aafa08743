// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/epipolar_system.h"

#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "calib/solver/loss.h"
#include "calib/solver/packed_pairs.h"
#include "calib/solver/resolve_pairs.h"

namespace vernier::internal {

EpipolarSums scaled_sums(const PackedPairs& packed,
                         const PackedPairs::Group* group,
                         const Rig& rig,
                         Loss loss,
                         double scale) {
  loss.limit *= scale;
  EpipolarSums sums =
      group ? epipolar_sums(packed, *group, rig, loss) : epipolar_sums(packed, rig, loss);
  const double by = 1 / (scale * scale);
  sums.information *= by;
  sums.gradient *= by;
  sums.cost *= by;
  return sums;
}

EpipolarSystem epipolar_system(const PackedPairs& packed,
                               const Rig& rig,
                               const EpipolarProblem& problem,
                               const Eigen::MatrixXd& E) {
  EpipolarSums sums = scaled_sums(packed, nullptr, rig, problem.loss, problem.sigma_scale);
  EpipolarSystem system;
  system.cost = sums.cost;
  for (const RigPrior& prior : problem.priors) {
    const PriorOffset offset = prior_offset(prior, rig);
    const Eigen::MatrixXd PJ = prior.information * offset.by_rig;
    sums.information += offset.by_rig.transpose() * PJ;
    sums.gradient += PJ.transpose() * offset.delta;
    system.prior_chi2 += offset.delta.dot(prior.information * offset.delta);
  }
  system.cost += system.prior_chi2;
  system.information = E.transpose() * sums.information * E;
  system.gradient = E.transpose() * sums.gradient;
  return system;
}

}  // namespace vernier::internal
