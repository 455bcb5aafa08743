// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/resolve_pairs.h"

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <utility>

#include "calib/base/decompositions.h"
#include "calib/estimate/held_parameters.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/solver/epipolar_system.h"
#include "calib/solver/packed_pairs.h"

namespace vernier::internal {
namespace {

/// The step of (S + λ diag S) δ = −g, scaled before it is factored.
Eigen::VectorXd damped_step(const EpipolarSystem& system, double damping) {
  const Eigen::VectorXd d =
      ((1 + damping) * system.information.diagonal()).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd S = d.asDiagonal() * system.information * d.asDiagonal();
  S.diagonal().setOnes();
  return d.cwiseProduct(solve_symmetric(S, Eigen::VectorXd(-d.cwiseProduct(system.gradient))));
}

}  // namespace

PairResolver::PairResolver(const PairObservations& pairs)
    : packed_(std::make_shared<PackedPairs>(pairs)) {}

EpipolarMinimum PairResolver::minimise(const Rig& start, const EpipolarProblem& problem) const {
  std::vector<bool> held = problem.held;
  if (held.empty()) held.assign(static_cast<std::size_t>(parameter_count(start)), false);
  EpipolarMinimum best{start, 0, 0, 0, false};
  Eigen::MatrixXd E = free_directions(start, held);
  EpipolarSystem system = epipolar_system(*packed_, start, problem, E);
  double damping = 0;
  for (; best.iterations < problem.max_iterations && !best.converged; ++best.iterations) {
    const Eigen::VectorXd step = damped_step(system, damping);
    const double length2 = step.dot(system.information * step);
    const Rig rig = retract(best.rig, E * step);
    const Eigen::MatrixXd E_there = free_directions(rig, held);
    EpipolarSystem there = epipolar_system(*packed_, rig, problem, E_there);
    // Accept a rise of the cost within rounding.
    if (std::isfinite(there.cost) && there.cost <= system.cost * (1 + 1e-12)) {
      best.rig = rig;
      system = std::move(there);
      E = E_there;
      damping = damping < 1e-9 ? 0 : 0.1 * damping;
      best.converged = length2 < 1e-16;
    } else {
      damping = damping == 0 ? 1e-6 : 10 * damping;
      if (damping > 1e9) break;
    }
  }
  best.cost = system.cost;
  best.prior_chi2 = system.prior_chi2;
  return best;
}

}  // namespace vernier::internal
