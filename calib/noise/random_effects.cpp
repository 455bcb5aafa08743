// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/random_effects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "calib/base/decompositions.h"
#include "calib/board/board_aspect.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/estimate/held_parameters.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/fit_corner_noise.h"
#include "calib/noise/frame_rows.h"
#include "calib/noise/restricted_likelihood.h"
#include "calib/noise/rig_knowledge.h"
#include "calib/noise/scaled_factor.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "calib/solver/normal_equations.h"

namespace vernier::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int most_steps = 12;

/// A round of components and minimum.
struct Round {
  bool new_starts;        ///< of the components
  double least_gain;      ///< of −2 l by another step of theirs
  double settled_sigmas;  ///< length of the last step, of rig and shape
};

/// At the usual minimum a shape is in the residuals of all frames, and which of several maxima of
/// the likelihood is the greatest cannot be told there. Roughly twice, then to the end.
constexpr std::array<Round, 3> rounds{
    {{false, 1e-2, 0.05}, {true, 1e-2, 0.05}, {false, 1e-4, 1e-5}}};

class EffectsProblem {
 public:
  EffectsProblem(const BoardObservations& observations,
                 const std::vector<bool>& held,
                 const std::vector<RigPrior>& priors,
                 NoiseParts parts,
                 BoardAspect aspect)
      : observations_(observations),
        held_(held),
        priors_(priors),
        parts_(parts),
        stretches_(aspect == BoardAspect::free) {}

  MatrixXd free(const Rig& rig) const { return free_directions(rig, held_); }
  bool stretches() const { return stretches_; }
  /// The number of fixed effects beside the rig's: the warp of the board, then its aspect.
  Index of_board() const { return (parts_.shape ? 2 : 0) + (stretches_ ? 1 : 0); }

  /// Linearised at the minimum's state, aspect and shape.
  RestrictedLikelihood at(const EffectsMinimum& minimum) const {
    const BoardState& state = minimum.state;
    const VectorXd& shape_m = minimum.shape_m;
    BoardObservations shaped = observations_;
    shaped.target_m = stretched_target(std::move(shaped.target_m), minimum.aspect);
    const Eigen::Matrix3Xd by_aspect = aspect_field(shaped.target_m);
    for (std::size_t i = 0; 3 * i < static_cast<std::size_t>(shape_m.size()); ++i) {
      shaped.target_m[i] += shape_m.segment<3>(3 * static_cast<Index>(i));
    }
    const MatrixXd E = free(state.rig);
    const BoardWarp warp = parts_.shape ? BoardWarp::free : BoardWarp::known;
    std::vector<FrameRows> frames = frame_rows(shaped, state, E, warp);
    for (FrameRows& rows : frames) {
      if (stretches_) add_board_unknowns({by_aspect}, rows);
    }
    return {frames, observations_.target_m, parts_,
            knowledge_of_priors(priors_, state.rig, E, E.cols() + of_board()), shape_m};
  }

 private:
  const BoardObservations& observations_;
  const std::vector<bool>& held_;
  const std::vector<RigPrior>& priors_;
  NoiseParts parts_;
  bool stretches_;
};

/// Moves state, aspect and shape by the Gauss–Newton step, of the rig's free directions, the warp,
/// the aspect and the shape; its length in standard deviations.
double move(const NoiseSolution& s, const EffectsProblem& problem, EffectsMinimum& minimum) {
  BoardState& state = minimum.state;
  VectorXd& shape_m = minimum.shape_m;
  const MatrixXd free = problem.free(state.rig);
  const Index n = free.cols();
  state.rig = retract(state.rig, free * s.step.head(n));
  for (std::size_t f = 0; f < state.T_first_board.size(); ++f) {
    state.T_first_board[f] =
        retract(state.T_first_board[f],
                Eigen::Matrix<double, 6, 1>(s.pose_steps.col(static_cast<Index>(f))));
  }
  if (shape_m.size() > 0) {
    state.warp_m += s.step.segment<2>(n);
    shape_m += s.step.tail(shape_m.size());
  }
  if (problem.stretches()) minimum.aspect += s.step[n + problem.of_board() - 1];
  return std::sqrt(std::max(0.0, s.step.dot(s.equations.information * s.step)));
}

/// Warp, aspect and shape eliminated: with z the rig and s all of these, the score of z is moved by
/// X = S_zs S_ss⁻¹, M = [I, −X]ᵀ; each frame keeps its own term Mᵀ S_f M, and the shape's prior
/// becomes X P Xᵀ.
void eliminate_shape(const ReducedNormalEquations& all, Index rig, EffectsMinimum& result) {
  const Index shape = all.information.rows() - rig;
  ReducedNormalEquations& z = result.equations;
  z = all;
  if (shape == 0) return;
  const ScaledFactor S_ss(all.information.bottomRightCorner(shape, shape), "the board's shape");
  const MatrixXd X = all.information.topRightCorner(rig, shape) * S_ss.inverse();
  MatrixXd M(rig + shape, rig);
  M << MatrixXd::Identity(rig, rig), -X.transpose();
  z.information = M.transpose() * all.information * M;
  z.held_poses_diagonal = all.held_poses_diagonal.head(rig);
  z.scores = M.transpose() * all.scores;
  for (MatrixXd& S : z.frame_information) S = (M.transpose() * S * M).eval();
  z.prior_information = M.transpose() * all.prior_information * M;
}

/// From these components, and from the usual starts if they are wanted.
NoiseFit best_fit(const RestrictedLikelihood& likelihood,
                  double spacing_m,
                  const CornerNoise& last,
                  const Round& round) {
  NoiseFit fit = fit_corner_noise(likelihood, spacing_m, last, round.least_gain);
  if (!round.new_starts) return fit;
  NoiseFit other = fit_corner_noise(likelihood, spacing_m, {}, round.least_gain);
  return fit.solution.minus_two_log <= other.solution.minus_two_log ? fit : other;
}

}  // namespace

EffectsMinimum minimise_with_effects(const BoardObservations& observations,
                                     const BoardState& start,
                                     const std::vector<bool>& held,
                                     const std::vector<RigPrior>& priors,
                                     NoiseParts parts,
                                     BoardAspect aspect) {
  std::vector<bool> all_held = held;
  all_held.resize(static_cast<std::size_t>(parameter_count(start.rig)), false);
  const EffectsProblem problem(observations, all_held, priors, parts, aspect);
  const double spacing_m = point_spacing_m(observations.target_m);
  EffectsMinimum result;
  result.state = start;
  if (parts.shape) {
    result.shape_m = VectorXd::Zero(3 * static_cast<Index>(observations.target_m.size()));
  }
  std::optional<CornerNoise> last;
  for (const Round& round : rounds) {
    const RestrictedLikelihood likelihood = problem.at(result);
    if (!last) last = usual_start(likelihood, spacing_m);
    result.noise = best_fit(likelihood, spacing_m, *last, round);
    if (&round == &rounds.back()) result.noise.noise = with_mean_motion(likelihood, result.noise);
    last = result.noise.noise;
    result.converged = false;
    for (int i = 0; i < most_steps && !result.converged; ++i) {
      const NoiseSolution s = problem.at(result).at(*last, RestrictedLikelihood::Want::step);
      const double length = move(s, problem, result);
      result.converged = length < round.settled_sigmas;
    }
  }
  result.noise.solution =
      problem.at(result).at(result.noise.noise, RestrictedLikelihood::Want::solution);
  result.free = problem.free(result.state.rig);
  result.converged = result.converged && result.noise.converged;
  if (problem.stretches()) {
    const Index at = result.free.cols() + problem.of_board() - 1;
    const ScaledFactor S(result.noise.solution.equations.information, "the board's aspect");
    const VectorXd unit = VectorXd::Unit(result.noise.solution.step.size(), at);
    result.aspect_sigma = std::sqrt(S.solve(unit)[at]);
  }
  eliminate_shape(result.noise.solution.equations, result.free.cols(), result);
  if (result.equations.prior_information.isZero(0)) result.equations.prior_information.resize(0, 0);
  return result;
}

}  // namespace vernier::internal
