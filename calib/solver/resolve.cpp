// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/resolve.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "calib/base/decompositions.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/solver/eliminated_boards.h"
#include "calib/solver/packed_views.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {
namespace {

constexpr double min_rcond = 3e-14;  // of the scaled reduced system
constexpr double far_step = 10;      // standard deviations
constexpr double min_rate = 0.03;    // assumed rate of convergence

/// A step of the rig and its quality.
struct Step {
  bool sound = false;  // the system is positive definite with a margin
  Eigen::VectorXd tangent;
  double length = 0;     // sqrt(δᵀ S δ), standard deviations times σ̂ / σ
  double predicted = 0;  // fall of χ²
};

Step solve(const ReducedSystem& system, const Eigen::MatrixXd& E) {
  Step step;
  const bool all = E.size() == 0;
  Eigen::MatrixXd S = system.information;
  Eigen::VectorXd g = system.gradient, scale = system.diagonal;
  if (!all) {
    S = E.transpose() * S * E;
    g = E.transpose() * g;
    scale = E.cwiseAbs2().transpose() * scale;
  }
  scale = scale.cwiseSqrt().cwiseInverse();
  S = scale.asDiagonal() * S * scale.asDiagonal();
  if (!S.allFinite() || !g.allFinite()) return step;
  const Cholesky factor(S);
  if (!factor.is_positive_definite()) return step;
  step.sound = S.rows() == 0 || factor.rcond() > min_rcond;
  const Eigen::VectorXd half = factor.solve_lower(Eigen::VectorXd(scale.cwiseProduct(-g)));
  const Eigen::VectorXd z = scale.cwiseProduct(factor.solve_upper(half));
  step.tangent = all ? z : E * z;
  step.length = half.norm();
  step.predicted = half.squaredNorm() + system.frames_drop;
  if (!step.tangent.allFinite()) step.sound = false;
  return step;
}

/// Estimated distance of the rig from the minimum after a step of `length`, in units of σ̂.
double error_after(double length, double previous) {
  const double rate = std::max(previous > 0 ? length / previous : 0.0, min_rate);
  if (rate >= 1) return std::numeric_limits<double>::infinity();
  return length * rate / (1 - rate);
}

constexpr double min_unit_px = 1e-3;  // smaller residuals are treated as exact

/// Marquardt's factor: zero while Gauss–Newton steps succeed, so that they converge at their own
/// rate; in a curved valley the smallest that makes steps succeed.
struct Damping {
  double value = 0;
  void ease() { value = value < 1e-9 ? 0 : value / 10; }
  /// Raises the damping from zero, by little if the failed step was short.
  void raise(bool far) { value = value == 0 ? (far ? 1e-4 : 1e-10) : value * 30; }
  bool hopeless() const { return value > 1e8; }
};

/// The iterations from one start.
class Descent {
 public:
  Descent(EliminatedBoards& boards,
          const ReprojectionProblem& cost,
          double tolerance_sigma,
          double dof,
          int parameters,
          const BoardState& start)
      : boards_(boards),
        cost_(cost),
        tolerance_sigma_(tolerance_sigma),
        dof_(std::max(dof, 1.0)),
        parameters_(parameters) {
    result_.state = start;
    linearise_again();
  }

  ResolveResult run() {
    bool done = false;
    while (!done && result_.iterations < cost_.max_iterations) done = take_step();
    if (!done) result_.status = ResolveStatus::iteration_limit;
    if (result_.status != ResolveStatus::converged) result_.chi2 = system_.chi2;
    return result_;
  }

 private:
  void linearise_again() {
    system_ = boards_.linearise(result_.state, damping_.value);
    ++result_.iterations;
  }

  /// Returns whether it was the last step.
  bool take_step() {
    const Step step = solve(system_, directions(result_.state.rig, cost_.held, parameters_));
    if (!step.sound) return leave_singular_point();
    // σ̂ / σ, bounded from above only by a stated σ below the smallest residuals
    const double unit =
        std::min(1.0, std::max(std::sqrt(system_.chi2 / dof_), min_unit_px / cost_.pixel_sigma_px));
    const bool damped = damping_.value > 0;
    const double length = step.length / unit;
    const double left = damped ? length : error_after(length, previous_length_);
    const BoardState next = boards_.moved(result_.state, step.tangent);
    if (!damped && left < tolerance_sigma_) {
      result_.state = next;
      result_.chi2 = std::max(0.0, system_.chi2 - step.predicted);
      result_.error_left_sigma = left;
      result_.status = ResolveStatus::converged;
      return true;
    }
    const Damping used = damping_;
    damping_.ease();
    ReducedSystem after = boards_.linearise(next, damping_.value);
    ++result_.iterations;
    if (after.chi2 <= system_.chi2 * (1 + 1e-12)) {
      previous_length_ = damped ? 0 : length;
      result_.error_left_sigma = left;
      result_.state = next;
      system_ = std::move(after);
      return false;
    }
    damping_ = used;
    damping_.raise(length > far_step);
    if (damping_.hopeless()) return stop(ResolveStatus::iteration_limit);
    linearise_again();
    return false;
  }

  /// Damping may lead to a state where the system is well-conditioned; it must be so without
  /// damping.
  bool leave_singular_point() {
    if (damping_.hopeless() || (was_singular_ && damping_.value == 0)) {
      return stop(ResolveStatus::singular);
    }
    was_singular_ = true;
    damping_.raise(true);
    linearise_again();
    return false;
  }

  bool stop(ResolveStatus status) {
    result_.status = status;
    return true;
  }

  EliminatedBoards& boards_;
  const ReprojectionProblem& cost_;
  double tolerance_sigma_, dof_;
  int parameters_;
  ResolveResult result_;
  ReducedSystem system_;
  Damping damping_;
  double previous_length_ = 0;  // of the last undamped step, in standard deviations
  bool was_singular_ = false;
};

}  // namespace

struct Resolver::Problem {
  BoardState around;
  ReprojectionProblem cost;
  ResolveOptions options;
  PackedViews views;
  Eigen::Matrix2Xd pixels_px;
  int rig_parameters, parameters;  // without and with the warp
  double dof;

  Problem(const BoardObservations& observations,
          const BoardState& state,
          ReprojectionProblem problem,
          const ResolveOptions& chosen)
      : around(state),
        cost(std::move(problem)),
        options(chosen),
        views(observations, state, cost),
        pixels_px(views.observed_px(observations)),
        rig_parameters(parameter_count(state.rig)),
        parameters(rig_parameters + (views.warp() ? 2 : 0)) {
    dof = 2.0 * static_cast<double>(views.corners()) - parameters -
          6.0 * static_cast<double>(state.frames.size());
  }
};

Resolver::Resolver(const BoardObservations& observations,
                   const BoardState& around,
                   ReprojectionProblem problem,
                   ResolveOptions options) {
  check_problem(observations, around.rig, problem);
  problem_ = std::make_shared<const Problem>(observations, around, std::move(problem), options);
}

ResolveResult Resolver::resolve() const { return resolve(problem_->pixels_px, problem_->around); }

ResolveResult Resolver::resolve(const Eigen::Matrix2Xd& pixels_px) const {
  return resolve(pixels_px, problem_->around);
}

ResolveResult Resolver::resolve(const Eigen::Matrix2Xd& pixels_px, const BoardState& start) const {
  const Problem& p = *problem_;
  EliminatedBoards boards(p.views, p.cost, p.views.pack(pixels_px), p.parameters,
                          p.options.threads);
  return Descent(boards, p.cost, p.options.tolerance_sigma, p.dof, p.parameters, start).run();
}

Eigen::MatrixXd Resolver::covariance(const BoardState& state) const {
  const int n = problem_->parameters;
  EliminatedBoards boards(problem_->views, problem_->cost,
                          problem_->views.pack(problem_->pixels_px), n, problem_->options.threads);
  const ReducedSystem system = boards.linearise(state, 0);
  Eigen::MatrixXd E = directions(state.rig, problem_->cost.held, n);
  if (E.size() == 0) E = Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd S = E.transpose() * system.information * E;
  const Eigen::VectorXd scale = S.diagonal().cwiseSqrt().cwiseInverse();
  const Cholesky factor(scale.asDiagonal() * S * scale.asDiagonal());
  if (!factor.is_positive_definite() || !(factor.rcond() > min_rcond)) {
    throw Error("calibration", "the views leave a direction undetermined",
                "add views at other tilts and distances, or use a model with fewer parameters");
  }
  const Eigen::MatrixXd half =
      factor.solve_lower(Eigen::MatrixXd(scale.asDiagonal() * E.transpose()));
  return (half.transpose() * half)
      .topLeftCorner(problem_->rig_parameters, problem_->rig_parameters);
}

}  // namespace vernier::internal
