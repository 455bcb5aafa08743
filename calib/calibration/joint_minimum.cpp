// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/joint_minimum.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "calib/base/decompositions.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/merged_boards.h"
#include "calib/estimate/held_parameters.h"
#include "calib/joint_calibration.h"
#include "calib/rig.h"
#include "calib/solver/epipolar_system.h"
#include "calib/solver/linearised_cost.h"
#include "calib/solver/loss.h"
#include "calib/solver/minimise_reprojection.h"
#include "calib/solver/normal_equations.h"
#include "calib/solver/packed_pairs.h"
#include "calib/solver/pair_equations.h"
#include "calib/solver/resolve_pairs.h"
#include "calib/statistics/quantile.h"

namespace vernier::internal {
namespace {

constexpr double huber_limit = 1.345, tukey_limit = 5;  // standard deviations
constexpr int huber_rounds = 12, tukey_rounds = 40;
constexpr double gross = 6;         // standard deviations, by the median residual of the moment
constexpr double min_scale = 0.01;  // of the stated noise: lower bound of the scale

double median_length(std::vector<double> values) {
  for (double& v : values) v = std::abs(v);
  return quantile(std::move(values), 0.5, QuantileKind::upper);
}

constexpr double normal_median = 0.6744897501960817;  // of |z|

/// Ceres compares costs, which rounding limits to 1e-6 standard deviations from the minimum; these
/// steps use the gradient. For pairs and priors only.
void polish(JointMinimum& joint) {
  if (joint.cost.pairs.size() == 0 || !joint.state.frames.empty()) return;
  const Eigen::MatrixXd E = free_directions(joint.state.rig, joint.cost.held);
  const PackedPairs weighted(joint.cost.pairs, joint.cost.pair_weights);
  EpipolarProblem problem;
  problem.priors = joint.cost.priors;
  problem.sigma_scale = joint.cost.pair_sigma_scale;
  for (int step = 0; step < 2; ++step) {
    const EpipolarSystem system = epipolar_system(weighted, joint.state.rig, problem, E);
    const Eigen::VectorXd d = system.information.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = d.asDiagonal() * system.information * d.asDiagonal();
    const Cholesky factor(scaled);
    if (!factor.is_positive_definite() || !(factor.rcond() > 1e-12)) return;
    const Eigen::VectorXd z = factor.solve(Eigen::VectorXd(d.cwiseProduct(system.gradient)));
    constexpr double near = 0.01;  // standard deviations; farther away Ceres did not converge
    if (!(z.dot(scaled * z) < near * near)) return;
    joint.state.rig = retract(joint.state.rig, E * (-d.cwiseProduct(z)));
  }
}

void minimise(JointMinimum& joint) {
  joint.state = minimise_reprojection(joint.boards.observations, joint.state, joint.cost);
  polish(joint);
  joint.residuals = joint.packed.residuals(joint.state.rig);
}

/// One round of iterated weights, 0 for residuals from `beyond` on; returns the largest change of a
/// weight.
double reweigh(JointMinimum& joint,
               const Loss& loss,
               double beyond = std::numeric_limits<double>::infinity()) {
  std::vector<double> weights;
  double change = joint.cost.pair_weights.empty() ? 1 : 0;
  for (std::size_t i = 0; i < joint.residuals.size(); ++i) {
    const bool is_near = std::abs(joint.residuals[i]) < beyond;
    weights.push_back(is_near ? weight_of(loss, joint.residuals[i] / joint.cost.pair_sigma_scale)
                              : 0);
    if (!joint.cost.pair_weights.empty()) {
      change = std::max(change, std::abs(weights[i] - joint.cost.pair_weights[i]));
    }
  }
  joint.cost.pair_weights = std::move(weights);
  return change;
}

ReducedNormalEquations of_nothing(int unknowns) {
  ReducedNormalEquations sum;
  sum.information = Eigen::MatrixXd::Zero(unknowns, unknowns);
  sum.held_poses_diagonal = Eigen::VectorXd::Zero(unknowns);
  sum.scores = Eigen::MatrixXd::Zero(unknowns, 0);
  return sum;
}

/// The number of parameters that the pairs determine at this scale, tr(C H).
double determined_by_pairs(const JointMinimum& joint) {
  const Eigen::MatrixXd E = free_directions(joint.state.rig, joint.cost.held);
  ReducedNormalEquations equations = restricted(
      pair_equations(joint.cost.pairs, joint.state.rig, joint.loss, joint.cost.pair_sigma_scale),
      E);
  const Eigen::MatrixXd H = equations.information;
  add_equations(equations, restricted(board_equations(joint), E));
  add_priors(equations, joint.cost.priors, joint.state.rig, E);
  const Eigen::MatrixXd& all = equations.information;
  const Eigen::VectorXd d = all.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = d.asDiagonal() * all * d.asDiagonal();
  const Eigen::MatrixXd scaled_H = d.asDiagonal() * H * d.asDiagonal();
  return solve_symmetric(scaled, scaled_H).trace();
}

}  // namespace

ReducedNormalEquations board_equations(const JointMinimum& joint) {
  const std::vector<BoardTerm>& terms = joint.terms;
  const bool bends = joint.boards.warp == BoardWarp::free;
  ReducedNormalEquations sum = of_nothing(parameter_count(joint.state.rig) + (bends ? 2 : 0));
  for (std::size_t b = 0; b < terms.size(); ++b) {
    const BoardObservations& views = terms[b].evidence.observations;
    const BoardState state = state_of(joint.boards, terms, joint.state, b);
    const double sigma_px = terms[b].pixel_sigma_px;
    add_equations(sum, bends ? equations_with_warp(views, state, sigma_px)
                             : reduced_normal_equations(views, state, sigma_px));
  }
  return bends ? without_warp(sum) : sum;
}

void minimise_robust(JointMinimum& joint, double fixed_scale) {
  const auto median_scale = [&] {
    return std::max(min_scale, median_length(joint.residuals) / normal_median);
  };
  joint.residuals = joint.packed.residuals(joint.state.rig);
  joint.cost.must_converge = false;  // until the weights have converged
  // From the residuals of the start down to the stated noise: a scale kept at the residuals would
  // let a wrong prior hold the rig where all pairs look noisy.
  const double stated = fixed_scale > 0 ? fixed_scale : 1;
  double scale = std::max(stated, median_scale());
  for (int round = 0; round < huber_rounds; ++round, scale = std::max(stated, 0.5 * scale)) {
    joint.cost.pair_sigma_scale = scale;
    // Matches that are wrong by a part of the image would still bend the lens over.
    const double beyond = gross * std::max(stated, median_scale());
    if (reweigh(joint, balanced(LossShape::huber, huber_limit), beyond) < 1e-2 && scale == stated) {
      break;
    }
    minimise(joint);
  }
  joint.loss = balanced(LossShape::tukey, tukey_limit);
  const auto settle = [&](auto scale_of_round) {
    for (int round = 0; round < tukey_rounds; ++round) {
      joint.cost.pair_sigma_scale = scale_of_round();
      if (reweigh(joint, joint.loss) < 1e-7) break;
      minimise(joint);
    }
  };
  settle([&] { return fixed_scale > 0 ? fixed_scale : median_scale(); });
  if (!(fixed_scale > 0)) {  // fitted parameters make residuals smaller than the noise
    const auto n = static_cast<double>(joint.residuals.size());
    const double share = std::min(0.9, determined_by_pairs(joint) / n);
    const double corrected = joint.cost.pair_sigma_scale / std::sqrt(1 - share);
    settle([&] { return corrected; });
  }
  joint.cost.must_converge = true;
  minimise(joint);
}

void minimise_least_squares(JointMinimum& joint, double fixed_scale) {
  joint.cost.pair_sigma_scale = fixed_scale > 0 ? fixed_scale : 1;
  constexpr int polish_rounds = 2;  // Ceres stops about 1e-6 σ from the minimum
  for (int round = 0; round < 20; ++round) {
    minimise(joint);
    if (fixed_scale > 0 || joint.residuals.empty()) {
      if (round >= polish_rounds) return;
      continue;
    }
    double squares = 0;
    for (const double r : joint.residuals) squares += r * r;
    const double dof =
        std::max(1.0, static_cast<double>(joint.residuals.size()) - determined_by_pairs(joint));
    const double scale = std::max(min_scale, std::sqrt(squares / dof));
    if (std::abs(scale / joint.cost.pair_sigma_scale - 1) < 1e-9) return;
    joint.cost.pair_sigma_scale = scale;
  }
}

bool is_outlier(const JointMinimum& joint, std::size_t row) {
  return joint.loss.shape != LossShape::square &&
         std::abs(joint.residuals[row]) >= joint.loss.limit * joint.cost.pair_sigma_scale;
}

}  // namespace vernier::internal
