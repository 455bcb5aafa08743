// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/fit_corner_noise.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/base/decompositions.h"
#include "calib/error.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/restricted_likelihood.h"

namespace vernier::internal {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double prior_precision = 1e-2;        // of each logarithm about its start: σ = 10
constexpr double shortest = 0.5, longest = 20;  // spacings, of the field
constexpr double longest_step = 2;              // of a logarithm
constexpr double first_damping = 0.1, least_damping = 0.03, most_damping = 1e8;
constexpr int most_iterations = 200;
constexpr double long_field = 6;  // spacings, of the second start

/// Half of −2 l with the weak prior, its gradient and its information by the unknowns.
struct CostAt {
  double value = HUGE_VAL, minus_two_log = HUGE_VAL;
  VectorXd gradient;
  MatrixXd information;

  /// −H⁻¹ g with the information's diagonal raised by `damping`, which holds back components that
  /// are hardly there; no element is above `longest_step`.
  VectorXd step(double damping) const {
    MatrixXd H = information;
    H.diagonal().array() += damping;
    const VectorXd step = -solve_symmetric(H, gradient);
    return step * std::min(1.0, longest_step / step.cwiseAbs().maxCoeff());
  }
  /// What −2 l would still fall by, were it quadratic.
  double gain() const { return gradient.dot(solve_symmetric(information, gradient)); }
};

/// The unknowns are logarithms relative to the start; the length's is mapped into its range by a
/// logistic function.
class NoiseCost {
 public:
  NoiseCost(const RestrictedLikelihood& likelihood, double spacing_m, const CornerNoise& start)
      : likelihood_(likelihood),
        start_(likelihood.logs(start)),
        low_(std::log(shortest * spacing_m)),
        width_(std::log(longest / shortest)) {}

  /// Infinite where the likelihood cannot be had.
  CostAt at(const VectorXd& unknowns) const {
    CostAt cost;
    try {
      const NoiseSolution s =
          likelihood_.at(noise_at(unknowns), RestrictedLikelihood::Want::gradient);
      VectorXd slopes = VectorXd::Ones(unknowns.size());
      if (likelihood_.parts().field) slopes[2] = length_slope(unknowns[2]);
      cost.gradient = 0.5 * slopes.cwiseProduct(s.gradient) + prior_precision * unknowns;
      cost.information = 0.5 * slopes.asDiagonal() * s.information * slopes.asDiagonal();
      cost.information.diagonal().array() += prior_precision;
      const double value = 0.5 * (s.minus_two_log + prior_precision * unknowns.squaredNorm());
      if (std::isfinite(value)) cost.value = value;
      cost.minus_two_log = s.minus_two_log;
    } catch (const Error&) {
    }
    return cost;
  }

  CornerNoise noise_at(const VectorXd& unknowns) const {
    VectorXd logs = start_ + unknowns.cwiseMax(-20.0).cwiseMin(20.0);
    if (likelihood_.parts().field) logs[2] = low_ + width_ * share(unknowns[2]);
    return likelihood_.noise(logs);
  }

  VectorXd at_start() const { return VectorXd::Zero(start_.size()); }

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
};

/// Of the solution −2 l alone.
NoiseFit fit_from(const RestrictedLikelihood& likelihood,
                  double spacing_m,
                  const CornerNoise& start,
                  double least_gain) {
  const NoiseCost cost(likelihood, spacing_m, start);
  NoiseFit fit;
  VectorXd x = cost.at_start();
  CostAt here = cost.at(x);
  double damping = first_damping;
  while (std::isfinite(here.value) && fit.iterations < most_iterations && damping < most_damping) {
    fit.converged = here.gain() < least_gain;
    if (fit.converged) break;
    ++fit.iterations;
    const VectorXd step = here.step(damping);
    CostAt there = cost.at(x + step);
    const double expected = -(here.gradient.dot(step) + 0.5 * step.dot(here.information * step));
    const double share = (here.value - there.value) / expected;
    damping = share > 0.75   ? std::max(damping / 10, least_damping)
              : share > 0.25 ? damping
                             : 10 * damping;
    if (!(there.value < here.value)) continue;
    x += step;
    here = std::move(there);
  }
  fit.noise = cost.noise_at(x);
  fit.parts = likelihood.parts();
  fit.solution.minus_two_log = here.minus_two_log;
  return fit;
}

}  // namespace

CornerNoise usual_start(const RestrictedLikelihood& likelihood,
                        double spacing_m,
                        double field_spacings) {
  // with little else, white noise alone has the residuals' size
  CornerNoise unit{1, 0, spacing_m, 1e-9, 1e-9, 1e-9, 1e-9, 1e-9};
  const NoiseSolution s = likelihood.at(unit, RestrictedLikelihood::Want::step);
  const double dof = static_cast<double>(likelihood.coordinates()) -
                     6.0 * static_cast<double>(likelihood.frames()) -
                     static_cast<double>(likelihood.rig_directions());
  const double sigma = std::sqrt(std::max(s.equations.chi2, 1e-12) / std::max(dof, 1.0));
  CornerNoise start;
  start.white_px = 0.7 * sigma;
  start.field_px = 0.5 * sigma;
  start.field_length_m = field_spacings * spacing_m;
  start.motion_m = start.motion_baseline_m = 0.004 * spacing_m;
  start.motion_rad = 1e-3;
  start.shape_plane_m = 0.001 * spacing_m;
  start.shape_height_m = 0.004 * spacing_m;
  return start;
}

NoiseFit fit_corner_noise(const RestrictedLikelihood& likelihood,
                          double spacing_m,
                          const std::optional<CornerNoise>& start,
                          double least_gain) {
  NoiseFit best = fit_from(likelihood, spacing_m,
                           start ? *start : usual_start(likelihood, spacing_m), least_gain);
  if (!start && likelihood.parts().field) {
    NoiseFit other =
        fit_from(likelihood, spacing_m, usual_start(likelihood, spacing_m, long_field), least_gain);
    if (other.solution.minus_two_log < best.solution.minus_two_log) best = std::move(other);
  }
  best.solution = likelihood.at(best.noise, RestrictedLikelihood::Want::solution);
  return best;
}

CornerNoise with_mean_motion(const RestrictedLikelihood& likelihood, const NoiseFit& fit) {
  if (!likelihood.parts().motion) return fit.noise;
  constexpr double least_freedom = 4;
  MatrixXd information = 0.5 * fit.solution.information;
  information.diagonal().array() += prior_precision;
  const Eigen::Index n = information.rows();
  const VectorXd v = solve_symmetric(information, MatrixXd(MatrixXd::Identity(n, n))).diagonal();
  VectorXd logs = likelihood.logs(fit.noise);
  const Eigen::Index first = likelihood.parts().field ? 3 : 1;
  const Eigen::Index count = likelihood.parts().baseline_motion ? 3 : 2;
  for (Eigen::Index k = first; k < first + count; ++k) {
    const double freedom = std::max(least_freedom, 1 / (2 * v[k]));
    logs[k] += 0.5 * std::log(freedom / (freedom - 2));
  }
  return likelihood.noise(logs);
}

}  // namespace vernier::internal
