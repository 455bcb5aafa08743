// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/resolver_oracle.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "calib/base/decompositions.h"
#include "calib/board/board_warp.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/minimum_variance_bound.h"
#include "calib/calibration/outliers.h"
#include "calib/camera.h"
#include "calib/estimate/held_parameters.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "calib/simulated_board.h"
#include "calib/solver/minimise_reprojection.h"
#include "calib/solver/normal_equations.h"
#include "calib/solver/reprojection_problem.h"
#include "calib/solver/resolve.h"

namespace vernier::test {

Reference::Reference(const BoardObservations& observations,
                     const BoardState& state,
                     const ReprojectionProblem& problem) {
  const double variance = problem.pixel_sigma_px * problem.pixel_sigma_px;
  const CornerResiduals all = corner_residuals(observations, state);
  for (std::size_t v = 0; v < all.size(); ++v) {
    for (std::size_t i = 0; i < all[v].size(); ++i) {
      const double w = problem.corner_weights.empty() ? 1 : problem.corner_weights[v][i];
      chi2 += w * all[v][i].squaredNorm() / variance;
      residuals += 2;
    }
  }
  for (const RigPrior& prior : problem.priors) chi2 += prior_chi2(prior, state.rig);
  const auto n = parameter_count(state.rig);
  const auto held = problem.held.empty() ? std::vector<bool>(n, false) : problem.held;
  const Eigen::MatrixXd E = free_directions(state.rig, held);
  auto equations = restricted(
      reduced_normal_equations(observations, state, problem.pixel_sigma_px, problem.warp), E);
  for (const RigPrior& prior : problem.priors) {
    const Eigen::MatrixXd by_free = prior_offset(prior, state.rig).by_rig * E;
    add_prior(equations, by_free.transpose() * prior.information * by_free);
  }
  covariance = E * minimum_variance_bound(equations, free_names(state.rig, held)) * E.transpose();
  sd = covariance.diagonal().cwiseSqrt();
  for (double& s : sd) s = s > 0 ? s : std::numeric_limits<double>::infinity();  // held
}

SimulatedBoard scene(const Rig& rig, int frames, double pixel_sigma_px) {
  return simulate_board(
      rig, {9, 7, 0.03},
      {.seed = 7, .frames = frames, .pixel_sigma_px = pixel_sigma_px, .distance_m = 0.9});
}

void make_partial(BoardObservations& observations) {
  for (std::size_t v = 0; v < observations.views.size(); ++v) {
    BoardView& view = observations.views[v];
    for (std::size_t i = view.ids.size(); i-- > 12;) {
      if ((i * 7 + v * 13) % (3 + v % 5) != 0) continue;
      view.ids.erase(view.ids.begin() + static_cast<std::ptrdiff_t>(i));
      view.pixels_px.erase(view.pixels_px.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
}

Eigen::VectorXd newton_step(const BoardObservations& observations,
                            const BoardState& state,
                            const ReprojectionProblem& problem) {
  auto equations =
      reduced_normal_equations(observations, state, problem.pixel_sigma_px, problem.warp);
  Eigen::VectorXd g = equations.scores.rowwise().sum();
  if (!problem.corner_weights.empty()) return Eigen::VectorXd::Zero(g.size());
  for (const RigPrior& prior : problem.priors) {
    const PriorOffset offset = prior_offset(prior, state.rig);
    equations.information += offset.by_rig.transpose() * prior.information * offset.by_rig;
    g += offset.by_rig.transpose() * prior.information * offset.delta;
  }
  Eigen::MatrixXd E = Eigen::MatrixXd::Identity(g.size(), g.size());
  if (!problem.held.empty()) E = free_directions(state.rig, problem.held);
  const Eigen::MatrixXd S = E.transpose() * equations.information * E;
  const Eigen::VectorXd scale = S.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::VectorXd right = scale.cwiseProduct(-E.transpose() * g);
  const Eigen::VectorXd z =
      scale.asDiagonal() * solve_symmetric(scale.asDiagonal() * S * scale.asDiagonal(), right);
  return E * z;
}

void expect_as_ceres(const BoardObservations& observations,
                     const BoardState& start,
                     const ReprojectionProblem& problem) {
  const double short_stop = model_name(start.rig.cameras[0].model) == "opencv8" ? 1e3 : 1;
  const BoardState ceres = minimise_reprojection(observations, start, problem);
  const Reference at(observations, ceres, problem);
  const ResolveResult ours = Resolver(observations, start, problem).resolve();
  ASSERT_EQ(ours.status, ResolveStatus::converged);
  EXPECT_NEAR(ours.chi2 / at.chi2, 1, 1e-9 * short_stop);
  EXPECT_NEAR(Reference(observations, ours.state, problem).chi2 / ours.chi2, 1, 1e-9);
  const double unit = std::min(1.0, std::sqrt(at.chi2 / at.residuals));
  const auto sigmas = [&](const Eigen::VectorXd& delta) {
    return delta.cwiseQuotient(at.sd).cwiseAbs().maxCoeff() / unit;
  };
  EXPECT_LT(sigmas(newton_step(observations, ours.state, problem)), 1e-6);
  const Rig minimum = retract(ceres.rig, newton_step(observations, ceres, problem));
  EXPECT_LT(sigmas(difference(ours.state.rig, minimum)),
            (problem.corner_weights.empty() ? 1e-6 : 1e-5) * short_stop);
  EXPECT_LT(sigmas(difference(ours.state.rig, ceres.rig)), 1e-5 * short_stop);
}

BoardState perturbed(const SimulatedBoard& board,
                     double sigmas,
                     const ReprojectionProblem& problem) {
  BoardState start = board.truth;
  const Reference at(board.observations, start, problem);
  Eigen::VectorXd sign = Eigen::VectorXd::Ones(at.sd.size());
  for (Eigen::Index i = 1; i < sign.size(); i += 2) sign[i] = -1;
  sign = at.sd.array().isFinite().select(sign, 0);
  const Eigen::VectorXd sd = at.sd.array().isFinite().select(at.sd, 0);
  start.rig = retract(start.rig, sigmas * sigma_px * sign.cwiseProduct(sd));
  for (Pose& T : start.T_first_board) {
    Eigen::Matrix<double, 6, 1> step;
    step << 1e-3, -1e-3, 2e-3, 1e-3, 1e-3, -2e-3;
    T = retract(T, 0.2 * sigmas * step);
  }
  return start;
}

SimulatedBoard bent(SimulatedBoard board, const Eigen::Vector2d& warp_m) {
  const auto target = warped_target(board.observations.target_m, warp_m);
  for (BoardView& view : board.observations.views) {
    const Camera& camera = board.truth.rig.cameras[view.camera];
    const Pose T =
        board.truth.rig.T_camera_first[view.camera] * board.truth.T_first_board[view.frame];
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      view.pixels_px[i] += project(camera, T * target[view.ids[i]]) -
                           project(camera, T * board.observations.target_m[view.ids[i]]);
    }
  }
  return board;
}

}  // namespace vernier::test
