// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/rig.h"
#include "calib/solver/loss.h"
#include "calib/solver/packed_pairs.h"
#include "calib/solver/resolve_pairs.h"

namespace vernier::internal {

/// Σ over pairs and priors in the free directions E: their information, and half the gradient.
struct EpipolarSystem {
  Eigen::MatrixXd information;  ///< priors included
  Eigen::VectorXd gradient;     ///< priors included
  double cost = 0, prior_chi2 = 0;
};
EpipolarSystem epipolar_system(const PackedPairs& packed,
                               const Rig& rig,
                               const EpipolarProblem& problem,
                               const Eigen::MatrixXd& E);

/// Sums with every residual divided by `scale`, and the limit of the loss in those units.
EpipolarSums scaled_sums(const PackedPairs& packed,
                         const PackedPairs::Group* group,
                         const Rig& rig,
                         Loss loss,
                         double scale);

}  // namespace vernier::internal
