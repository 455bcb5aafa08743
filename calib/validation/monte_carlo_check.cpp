// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/validation/monte_carlo_check.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>

#include "calib/base/decompositions.h"
#include "calib/base/ordered_parallel.h"
#include "calib/base/shown_text.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/outliers.h"
#include "calib/error.h"
#include "calib/estimate/stable_coordinates.h"
#include "calib/interval.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "calib/solver/reprojection_problem.h"
#include "calib/solver/resolve.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/quantile.h"
#include "calib/statistics/random.h"
#include "calib/statistics/scaled_root.h"

namespace vernier::internal {
namespace {

constexpr int wishart_draws = 2000;
constexpr double min_p = 0.005;

/// Generates the noisy copies of one calibration.
class Copies {
 public:
  Copies(const BoardObservations& observations,
         const BoardState& state,
         const ReprojectionProblem& problem,
         std::uint64_t seed)
      : observations_(observations), state_(state), problem_(problem), seed_(seed) {
    const CornerResiduals residuals = corner_residuals(observations, state);
    for (std::size_t v = 0; v < residuals.size(); ++v) {
      auto& predicted = predicted_.emplace_back(observations.views[v].pixels_px);
      for (std::size_t i = 0; i < predicted.size(); ++i) predicted[i] += residuals[v][i];
      corners_ += static_cast<Eigen::Index>(predicted.size());
    }
    for (const RigPrior& prior : problem.priors) {
      priors_.emplace_back(prior.information);
      centred_.push_back(with_mean(prior, state.rig));
    }
    if (problem.priors.empty()) resolver_.emplace(observations, state, problem);
  }

  ResolveResult solve(std::uint32_t trial) const {
    if (resolver_) return resolver_->resolve(pixels(trial));
    ReprojectionProblem problem = problem_;
    for (std::size_t k = 0; k < priors_.size(); ++k) {
      // P = root rootᵀ: the mean's covariance is the pseudo-inverse, of root whiteᵀ z.
      RandomStream draws(of_prior(place(trial, 0), static_cast<std::uint32_t>(k)));
      const Eigen::MatrixXd& white = priors_[k].white;
      const Eigen::VectorXd off = white.transpose() * draws.normals(static_cast<int>(white.rows()));
      const RigPrior& about = centred_[k];
      problem.priors[k] = with_mean(
          about, about.coordinates ? about.coordinates->rig(off).rig : retract(state_.rig, off));
    }
    return Resolver(observations_, state_, problem).resolve(pixels(trial));
  }

 private:
  RandomCounter place(std::uint32_t trial, std::uint32_t feature) const {
    return {.seed = seed_,
            .trial = trial,
            .feature = feature,
            .source = static_cast<std::uint32_t>(DrawSource::noisy_copy)};
  }

  Eigen::Matrix2Xd pixels(std::uint32_t trial) const {
    Eigen::Matrix2Xd all(2, corners_);
    Eigen::Index at = 0;
    for (std::size_t v = 0; v < predicted_.size(); ++v) {
      const BoardView& view = observations_.views[v];
      RandomStream draws(of_view(place(trial, 0), view.frame, view.camera));
      for (std::size_t i = 0; i < predicted_[v].size(); ++i) {
        const double w = problem_.corner_weights.empty() ? 1 : problem_.corner_weights[v][i];
        const double sigma = problem_.pixel_sigma_px / std::sqrt(w > 0 ? w : 1);
        const double du = draws.normal(), dv = draws.normal();
        all.col(at++) = predicted_[v][i] + sigma * Eigen::Vector2d(du, dv);
      }
    }
    return all;
  }

  const BoardObservations& observations_;
  const BoardState& state_;
  const ReprojectionProblem& problem_;
  std::uint64_t seed_;
  std::vector<std::vector<Eigen::Vector2d>> predicted_;
  Eigen::Index corners_ = 0;
  std::vector<ScaledRoot> priors_;
  std::vector<RigPrior> centred_;  ///< about the state's rig
  std::optional<Resolver> resolver_;
};

/// Quantiles, each with probability 0.5 % beyond, of the extreme eigenvalues of W / n with W a
/// Wishart matrix of n degrees of freedom, by Bartlett's decomposition.
Interval wishart_band(int q, int n, std::uint64_t seed) {
  std::vector<double> least(wishart_draws), largest(wishart_draws);
  for (int k = 0; k < wishart_draws; ++k) {
    RandomStream draws({.seed = seed,
                        .trial = static_cast<std::uint32_t>(k),
                        .source = static_cast<std::uint32_t>(DrawSource::wishart)});
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(q, q);
    for (int i = 0; i < q; ++i) {
      A(i, i) = std::sqrt(draw_chi_squared(draws, n - i));
      for (int j = 0; j < i; ++j) A(i, j) = draws.normal();
    }
    const Eigen::VectorXd eigenvalues = symmetric_eigenvalues(A * A.transpose() / n);
    least[k] = eigenvalues[0];
    largest[k] = eigenvalues[q - 1];
  }
  return {quantile(std::move(least), 0.005, QuantileKind::upper),
          quantile(std::move(largest), 0.995, QuantileKind::lower)};
}

Interval mean_interval(double q, double n, double probability) {
  const double tail = 0.5 * (1 - probability);
  return {chi_squared_quantile(tail, n * q) / n, chi_squared_quantile(1 - tail, n * q) / n};
}

/// Evaluates the covariance with the errors (one column per copy).
void evaluate_covariance(const Eigen::MatrixXd& errors,
                         const Eigen::MatrixXd& covariance,
                         const ScaledRoot& root,
                         std::uint64_t seed,
                         MonteCarloCheck& check) {
  const auto n = static_cast<double>(errors.cols());
  const Eigen::MatrixXd white = root.white * errors;
  const auto q = static_cast<int>(white.rows());
  const Eigen::VectorXd nees = white.colwise().squaredNorm();
  check.nees_mean = nees.mean();
  check.nees_expected = q;
  check.nees_interval_95 = mean_interval(q, n, 0.95);
  check.nees_interval_99 = mean_interval(q, n, 0.99);

  check.std_ratio_min = 1e300;
  for (Eigen::Index i = 0; i < errors.rows(); ++i) {
    const double sd = std::sqrt(std::max(0.0, covariance(i, i)));
    const double ratio = sd > 0 ? std::sqrt(errors.row(i).squaredNorm() / n) / sd : 0;
    check.std_ratios.push_back(ratio);
    if (!(sd > 0)) continue;
    check.std_ratio_min = std::min(check.std_ratio_min, ratio);
    check.std_ratio_max = std::max(check.std_ratio_max, ratio);
  }

  const Eigen::VectorXd eigenvalues = symmetric_eigenvalues(white * white.transpose() / n);
  check.eigenvalues = {eigenvalues[0], eigenvalues[q - 1]};
  check.eigenvalue_band_99 = wishart_band(q, static_cast<int>(n), seed);
  check.ks_p = kolmogorov_smirnov_p({nees.begin(), nees.end()},
                                    [&](double x) { return chi_squared_cdf(x, q); });
  double least = 1;
  for (int i = 0; i < q; ++i) {
    const Eigen::VectorXd row = white.row(i);
    least = std::min(least, kolmogorov_smirnov_p({row.begin(), row.end()}, normal_cdf));
  }
  check.ks_p_components = std::min(1.0, q * least);
}

constexpr int fewest_trials(int parameters) { return 2 * parameters; }

void require_enough_trials(int parameters, int trials) {
  if (parameters == 0) {
    throw Error("Monte-Carlo check", "no parameter is free",
                "check a calibration with free parameters");
  }
  if (trials < fewest_trials(parameters)) {
    throw Error("Monte-Carlo check",
                fmt::format("{} {} too few for {}", counted(trials, "trial"),
                            trials == 1 ? "is" : "are", counted(parameters, "parameter")),
                fmt::format("ask for at least {}", fewest_trials(parameters)));
  }
}

}  // namespace

bool MonteCarloCheck::enough_trials_solved() const { return 100 * failed <= trials + failed; }

std::vector<std::string> MonteCarloCheck::departures() const {
  std::vector<std::string> found;
  if (!(nees_mean >= nees_interval_99.low && nees_mean <= nees_interval_99.high)) {
    found.push_back(
        fmt::format("the mean NEES is {:.4g}, outside its 99 % interval [{:.4g}, {:.4g}]",
                    nees_mean, nees_interval_99.low, nees_interval_99.high));
  }
  const Interval& band = eigenvalue_band_99;
  const auto add = [&](const char* which, double value) {
    found.push_back(
        fmt::format("the {} eigenvalue of the whitened samples is {:.4g}, outside [{:.4g}, {:.4g}]",
                    which, value, band.low, band.high));
  };
  if (!(eigenvalues[0] >= band.low)) add("smallest", eigenvalues[0]);
  if (!(eigenvalues[1] <= band.high)) add("largest", eigenvalues[1]);
  const auto test = [&](const char* of, double p) {
    if (p > min_p) return;
    found.push_back(
        fmt::format("Kolmogorov-Smirnov of the {} gives p = {:.2g}, not above {:g}", of, p, min_p));
  };
  test("NEES", ks_p);
  test("components", ks_p_components);
  return found;
}

void require_enough_trials(const Eigen::MatrixXd& covariance, int trials) {
  require_enough_trials(static_cast<int>(ScaledRoot(covariance).white.rows()), trials);
}

MonteCarloCheck monte_carlo_check(const BoardObservations& observations,
                                  const BoardState& state,
                                  const ReprojectionProblem& problem,
                                  const Eigen::MatrixXd& covariance,
                                  const MonteCarloOptions& options) {
  const int p = parameter_count(state.rig);
  if (covariance.rows() != p || covariance.cols() != p) {
    throw Error("covariance", "its size does not match the number of the rig's parameters",
                "give it in full, with zeros for fixed parameters");
  }
  const ScaledRoot root(covariance);
  const auto parameters = static_cast<int>(root.white.rows());
  require_enough_trials(parameters, options.trials);
  const StableCoordinates about_state(state.rig, covariance);
  const Copies copies(observations, state, problem, options.seed);
  Eigen::MatrixXd errors(p, options.trials);
  std::vector<char> solved(static_cast<std::size_t>(options.trials), 0);
  for_each_index(solved.size(), options.threads, [&](std::size_t trial) {
    const ResolveResult result = copies.solve(static_cast<std::uint32_t>(trial));
    solved[trial] = result.status == ResolveStatus::converged;
    errors.col(static_cast<Eigen::Index>(trial)) = about_state.coordinates(result.state.rig);
  });
  MonteCarloCheck check;
  for (std::size_t i = 0; i < solved.size(); ++i) {
    if (solved[i]) errors.col(check.trials++) = errors.col(static_cast<Eigen::Index>(i));
  }
  check.failed = options.trials - check.trials;
  if (check.trials < fewest_trials(parameters)) {
    throw Error(
        "Monte-Carlo check",
        fmt::format("of {} copies {} could be solved; {} need {}", options.trials, check.trials,
                    counted(parameters, "parameter"), fewest_trials(parameters)),
        "ask for more trials");
  }
  const Eigen::MatrixXd found = errors.leftCols(check.trials);
  evaluate_covariance(found, covariance, root, options.seed, check);
  return check;
}

}  // namespace vernier::internal
