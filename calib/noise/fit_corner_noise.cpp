// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/fit_corner_noise.h"

#include <ceres/first_order_function.h>
#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <algorithm>
#include <cmath>

#include "calib/error.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/restricted_likelihood.h"
#include "calib/statistics/distributions.h"

namespace vernier::internal {
namespace {

using Eigen::VectorXd;

constexpr double prior_precision = 1e-2;        // of each logarithm about its start: σ = 10
constexpr double shortest = 0.5, longest = 20;  // spacings, of the field

/// −2 l relative to the first evaluation, half of it, with the weak prior. The length is x mapped
/// into its range by a logistic function.
class NoiseCost : public ceres::FirstOrderFunction {
 public:
  NoiseCost(const RestrictedLikelihood& likelihood, double spacing_m, const CornerNoise& start)
      : likelihood_(likelihood),
        start_(likelihood.logs(start)),
        low_(std::log(shortest * spacing_m)),
        width_(std::log(longest / shortest)),
        best_(VectorXd::Zero(start_.size())) {}

  bool Evaluate(const double* x, double* cost, double* gradient) const override {
    const Eigen::Map<const VectorXd> unknowns(x, start_.size());
    try {
      const NoiseSolution s =
          likelihood_.at(noise_at(unknowns), RestrictedLikelihood::Want::gradient);
      if (best_cost_ == HUGE_VAL) at_first_ = s.minus_two_log;
      *cost = 0.5 * (s.minus_two_log - at_first_ + prior_precision * unknowns.squaredNorm());
      VectorXd g = 0.5 * s.gradient + prior_precision * unknowns;
      if (likelihood_.parts().field) g[2] += 0.5 * s.gradient[2] * (length_slope(x[2]) - 1);
      if (gradient) Eigen::Map<VectorXd>(gradient, start_.size()) = g;
      if (*cost < best_cost_) {
        best_cost_ = *cost;
        best_ = unknowns;
        gradient_at_best_ = g.cwiseAbs().maxCoeff();
      }
      return std::isfinite(*cost);
    } catch (const Error&) {
      return false;
    }
  }
  int NumParameters() const override { return static_cast<int>(start_.size()); }

  /// The unknowns of the least cost so far.
  const VectorXd& best() const { return best_; }
  /// The largest element of the gradient there.
  double gradient_at_best() const { return gradient_at_best_; }

  CornerNoise noise_at(const VectorXd& unknowns) const {
    VectorXd logs = start_ + unknowns.cwiseMax(-20.0).cwiseMin(20.0);
    if (likelihood_.parts().field) logs[2] = low_ + width_ * share(unknowns[2]);
    return likelihood_.noise(logs);
  }

 private:
  /// In (0, 1); at 0 that of the start.
  double share(double x) const {
    const double s0 = std::clamp((start_[2] - low_) / width_, 0.01, 0.99);
    const double odds = std::log(s0 / (1 - s0)) + 4 * x / width_;
    return 1 / (1 + std::exp(-odds));
  }
  double length_slope(double x) const { return 4 * share(x) * (1 - share(x)); }

  const RestrictedLikelihood& likelihood_;
  VectorXd start_;
  double low_, width_;
  mutable double at_first_ = 0;
  mutable VectorXd best_;  // Ceres evaluates one point at a time
  mutable double best_cost_ = HUGE_VAL, gradient_at_best_ = HUGE_VAL;
};

CornerNoise default_start(const RestrictedLikelihood& likelihood, double spacing_m) {
  // with little else, white noise alone has the residuals' size
  CornerNoise unit{1, 0, spacing_m, 1e-9, 1e-9, 1e-9, 1e-9};
  const NoiseSolution s = likelihood.at(unit, RestrictedLikelihood::Want::step);
  const double dof = static_cast<double>(likelihood.coordinates()) -
                     6.0 * static_cast<double>(likelihood.frames()) -
                     static_cast<double>(likelihood.rig_directions());
  const double sigma = std::sqrt(std::max(s.equations.chi2, 1e-12) / std::max(dof, 1.0));
  CornerNoise start;
  start.white_px = 0.7 * sigma;
  start.field_px = 0.5 * sigma;
  start.field_length_m = 2 * spacing_m;
  start.motion_m = 0.004 * spacing_m;
  start.motion_rad = 1e-3;
  start.shape_plane_m = 0.001 * spacing_m;
  start.shape_height_m = 0.004 * spacing_m;
  return start;
}

/// Two variances, each on the edge of its range.
ComponentTest two_variances_test(double minus_two_log, double minus_two_log_without) {
  const double ratio = std::max(0.0, minus_two_log_without - minus_two_log);
  if (!(ratio > 0)) return {};
  return {ratio, 0.5 * chi_squared_survival(ratio, 1) + 0.25 * chi_squared_survival(ratio, 2)};
}

}  // namespace

NoiseFit fit_corner_noise(const RestrictedLikelihood& likelihood,
                          double spacing_m,
                          const std::optional<CornerNoise>& start,
                          double largest_gradient) {
  const CornerNoise from = start ? *start : default_start(likelihood, spacing_m);
  auto* cost = new NoiseCost(likelihood, spacing_m, from);  // owned by the problem
  const ceres::GradientProblem problem(cost);
  VectorXd x = VectorXd::Zero(cost->NumParameters());
  ceres::GradientProblemSolver::Options options;
  options.line_search_direction_type = ceres::BFGS;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-10;
  options.gradient_tolerance = largest_gradient;
  options.parameter_tolerance = 1e-6;
  options.logging_type = ceres::SILENT;
  NoiseFit fit;
  for (int attempt = 0; attempt < 4 && !fit.converged; ++attempt) {
    ceres::GradientProblemSolver::Summary summary;
    ceres::Solve(options, problem, x.data(), &summary);
    x = cost->best();  // a line search that fails returns to its start
    fit.iterations += static_cast<int>(summary.iterations.size());
    fit.converged = cost->gradient_at_best() <= largest_gradient;
  }
  fit.noise = cost->noise_at(x);
  fit.parts = likelihood.parts();
  fit.solution = likelihood.at(fit.noise, RestrictedLikelihood::Want::solution);
  return fit;
}

ComponentTest motion_test(double minus_two_log, double minus_two_log_without) {
  return two_variances_test(minus_two_log, minus_two_log_without);
}

ComponentTest shape_test(double minus_two_log, double minus_two_log_without) {
  return two_variances_test(minus_two_log, minus_two_log_without);
}

ComponentTest field_test(double minus_two_log, double minus_two_log_without) {
  const double ratio = std::max(0.0, minus_two_log_without - minus_two_log);
  if (!(ratio > 0)) return {};
  return {ratio, 0.5 * chi_squared_survival(ratio, 1) + 0.5 * chi_squared_survival(ratio, 2)};
}

}  // namespace vernier::internal
