// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/mrcal/mrcal_solver.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <utility>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/error.h"
#include "calib/mrcal/mrcal_parameters.h"
#include "calib/mrcal/mrcal_problem.h"
#include "calib/solver/square_root_system.h"

namespace vernier::internal {
namespace {

/// Milliseconds since construction.
class Stopwatch {
 public:
  double cpu_ms() const { return 1e3 * static_cast<double>(std::clock() - cpu_) / CLOCKS_PER_SEC; }
  double wall_ms() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - wall_)
        .count();
  }

 private:
  std::clock_t cpu_ = std::clock();
  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
};

/// Rows of one frame, [B | A L | r], without the zero rows of unobserved corners.
Eigen::MatrixXd frame_rows_of(const MrcalEvaluation& e,
                              int begin,
                              int end,
                              Eigen::Index frame_state,
                              const Eigen::MatrixXd& L) {
  const auto p = L.cols();
  Eigen::MatrixXd rows(end - begin, 6 + p + 1);
  Eigen::Index used = 0;
  for (int row = begin; row < end; ++row) {
    auto out = rows.row(used);
    out.setZero();
    bool seen = false;
    for (int k = e.row_start[row]; k < e.row_start[row + 1]; ++k) {
      seen = seen || e.value[k] != 0;
      if (e.state[k] < L.rows()) {
        out.segment(6, p) += e.value[k] * L.row(e.state[k]);
      } else {
        out[e.state[k] - frame_state] = e.value[k];
      }
    }
    out[6 + p] = e.residual_px[row];
    if (seen) ++used;
  }
  return rows.topRows(used);
}

/// 1 / scale of each free parameter, with the scale of the state it moves most.
Eigen::VectorXd inverse_scales(const Eigen::MatrixXd& L, const Eigen::VectorXd& scales) {
  Eigen::VectorXd inverse(L.cols());
  for (Eigen::Index j = 0; j < L.cols(); ++j) {
    Eigen::Index state = 0;
    L.col(j).cwiseAbs().maxCoeff(&state);
    inverse[j] = 1 / scales[state];
  }
  return inverse;
}

/// Levenberg–Marquardt on mrcal's residuals and Jacobian over the free parameters.
class ReducedSolver {
 public:
  ReducedSolver(MrcalProblem& problem, const Eigen::MatrixXd& lift)
      : problem_(problem),
        lift_(lift),
        scales_(problem.packing_scales()),
        at_(problem.evaluate()),
        cost_(at_.residual_px.squaredNorm()) {}

  double cost() const { return cost_; }
  /// The remaining correction of the rig, in standard deviations at a noise of σ̂.
  double distance_sigma() const { return system(0).step_sigma() / noise_px(); }
  Eigen::MatrixXd covariance() const { return system(0).covariance(); }

  /// Iterates to the minimum up to rounding. False if it is not reached.
  bool solve(int max_iterations) {
    double damping = 0, before = INFINITY;
    for (int i = 0; i < max_iterations; ++i) {
      const double distance = distance_sigma();
      if (distance < 1e-11 || (distance < 1e-8 && distance > 0.5 * before)) return true;
      before = distance;
      if (!step(damping)) return distance < 1e-8;
    }
    return distance_sigma() < 1e-8;
  }

 private:
  /// With damping λ > 0 every unknown gets an additional residual √λ times itself over its scale.
  SquareRootSystem system(double damping) const {
    const auto p = lift_.cols();
    const double root = std::sqrt(damping);
    SquareRootSystem out(static_cast<int>(p));
    const std::vector<int>& begins = problem_.frame_rows();
    for (std::size_t f = 0; f + 1 < begins.size(); ++f) {
      const Eigen::Index state = lift_.rows() + 6 * static_cast<Eigen::Index>(f);
      Eigen::MatrixXd rows = frame_rows_of(at_, begins[f], begins[f + 1], state, lift_);
      if (damping > 0) {
        rows.conservativeResize(rows.rows() + 6, Eigen::NoChange);
        rows.bottomRows<6>().setZero();
        rows.bottomLeftCorner<6, 6>().diagonal() = root * scales_.segment<6>(state).cwiseInverse();
      }
      out.add_frame(rows);
    }
    if (damping > 0) {
      Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(p, p + 1);
      rows.leftCols(p).diagonal() = root * inverse_scales(lift_, scales_);
      out.add_rows(rows);
    }
    return out;
  }

  double noise_px() const {
    const auto unknowns = lift_.cols() + problem_.state().size() - lift_.rows();
    Eigen::Index measured = 0;
    for (Eigen::Index row = 0; row < at_.residual_px.size(); ++row) {
      measured += at_.residual_px[row] != 0 ? 1 : 0;
    }
    const double freedom = std::max<double>(1, static_cast<double>(measured - unknowns));
    return std::max(1e-9, std::sqrt(cost_ / freedom));
  }

  /// One step that does not raise the cost by more than rounding, with as much damping as needed.
  bool step(double& damping) {
    const Eigen::VectorXd start = problem_.state();
    for (int attempt = 0; attempt < 30; ++attempt) {
      const SquareRootSystem linear = system(damping);
      const Eigen::VectorXd rig = linear.step();
      Eigen::VectorXd& b = problem_.state();
      b.head(lift_.rows()) += lift_ * rig;
      b.tail(b.size() - lift_.rows()) += linear.frame_steps(rig);
      MrcalEvaluation tried = problem_.evaluate();
      const double cost = tried.residual_px.squaredNorm();
      if (cost <= cost_ * (1 + 1e-13)) {
        at_ = std::move(tried);
        cost_ = cost;
        damping = damping < 1e-6 ? 0 : 0.1 * damping;
        return true;
      }
      b = start;
      damping = std::max(1e-3, 10 * damping);
    }
    return false;
  }

  MrcalProblem& problem_;
  const Eigen::MatrixXd& lift_;
  Eigen::VectorXd scales_;
  MrcalEvaluation at_;
  double cost_;
};

/// Maps the covariance of the free parameters to those of mrcal_parameters.
Eigen::MatrixXd shown_covariance(const Eigen::MatrixXd& reduced, const MrcalLift& lift) {
  const Eigen::MatrixXd all = lift.L * reduced * lift.L.transpose();
  return all(lift.shown, lift.shown);
}

}  // namespace

MrcalSolution mrcal_solve(const BoardObservations& observations,
                          const BoardState& start,
                          const std::vector<bool>& held) {
  MrcalSolution solution;
  MrcalProblem problem(observations, start);
  const MrcalLift lift = mrcal_lift(start.rig, held);
  solution.timed_lens = mrcal_lens(start.rig).name;

  const Eigen::VectorXd first = problem.state();
  solution.solve_cpu_ms = solution.solve_wall_ms = INFINITY;
  for (int run = 0; run < 3; ++run) {  // the shortest time is the least disturbed
    problem.state() = first;
    const Stopwatch watch;
    problem.optimise();
    solution.solve_cpu_ms = std::min(solution.solve_cpu_ms, watch.cpu_ms());
    solution.solve_wall_ms = std::min(solution.solve_wall_ms, watch.wall_ms());
  }
  if (!lift.native) problem.state() = first;

  ReducedSolver solver(problem, lift.L);
  if (lift.native) solution.stopped_short_sigma = solver.distance_sigma();
  if (!solver.solve(100)) {
    throw Error("mrcal", "no minimum of its cost was found from the start", "leave mrcal out");
  }
  solution.state = problem.board_state(start);
  solution.cost_px2 = solver.cost();
  solution.unit_covariance = shown_covariance(solver.covariance(), lift);
  return solution;
}

double mrcal_optimise_only(const BoardObservations& observations, const BoardState& start) {
  MrcalProblem problem(observations, start);
  problem.optimise();
  return problem.evaluate().residual_px.squaredNorm();
}

}  // namespace vernier::internal
