// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/joint_summary.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/board_state.h"
#include "calib/calibration/change_findings.h"
#include "calib/calibration/joint_minimum.h"
#include "calib/calibration/pair_checks.h"
#include "calib/covariance.h"
#include "calib/estimate/observability.h"
#include "calib/joint_calibration.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"
#include "calib/solver/normal_equations.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/scaled_root.h"

namespace vernier::internal {
namespace {

std::vector<PairOutlier> outliers_of(const JointMinimum& joint) {
  std::vector<PairOutlier> outliers;
  for (const ImagePair& image : joint.cost.pairs.image_pairs) {
    for (std::size_t i = image.first; i < image.first + image.count; ++i) {
      if (!is_outlier(joint, i)) continue;
      outliers.push_back({image.number, i, joint.cost.pairs.pixels_px[i],
                          joint.residuals[i] * joint.cost.pairs.sigma_of(i)});
    }
  }
  return outliers;
}

/// χ² of the prior over the held parameters whose value differs from its own, and their number.
std::pair<double, int> of_held(const GaussianRigPrior& prior, const JointMinimum& joint) {
  const std::vector<std::string> all = parameter_names(joint.state.rig);
  const Eigen::VectorXd x = parameters(joint.state.rig), mean = parameters(prior.rig);
  const std::vector<std::string> own = parameter_names(prior.rig);
  std::vector<Eigen::Index> held;
  std::vector<double> moved;
  for (std::size_t i = 0; i < prior.covariance.names.size(); ++i) {
    const auto at = std::find(all.begin(), all.end(), prior.covariance.names[i]) - all.begin();
    if (joint.cost.held.empty() || !joint.cost.held[static_cast<std::size_t>(at)]) continue;
    const auto before = std::find(own.begin(), own.end(), prior.covariance.names[i]) - own.begin();
    held.push_back(static_cast<Eigen::Index>(i));
    moved.push_back(x[at] - mean[before]);
  }
  if (held.empty()) return {0, 0};
  const Eigen::VectorXd z =
      ScaledRoot(prior.covariance.matrix(held, held)).white *
      Eigen::Map<const Eigen::VectorXd>(moved.data(), static_cast<Eigen::Index>(moved.size()));
  return {z.squaredNorm(), static_cast<int>(held.size())};
}

/// Numbers of image pairs whose matches are outliers for the most part.
std::vector<int> lost_image_pairs(const PairObservations& pairs,
                                  const std::vector<PairOutlier>& outliers) {
  std::vector<int> lost;
  for (const ImagePair& image : pairs.image_pairs) {
    const auto out = static_cast<std::size_t>(
        std::count_if(outliers.begin(), outliers.end(),
                      [&](const PairOutlier& o) { return o.image_pair == image.number; }));
    if (image.count >= fewest_judged_matches && 2 * out > image.count) lost.push_back(image.number);
  }
  return lost;
}

}  // namespace

CalibrationSummary summary_of(const JointMinimum& joint,
                              const JointEvidence& evidence,
                              const PairObservations& inliers,
                              const ReducedNormalEquations& plain,
                              const Eigen::MatrixXd& bound) {
  CalibrationSummary summary;
  summary.source = evidence.boards.empty() && evidence.priors.size() <= 1 ? "pairs" : "combined";
  summary.pair_outliers = outliers_of(joint);
  summary.views = static_cast<int>(joint.state.frames.size() + joint.cost.pairs.image_pairs.size());
  double squares_px = 0, sigma = 0;
  for (std::size_t i = 0; i < joint.cost.pairs.size(); ++i) {
    if (is_outlier(joint, i)) continue;
    squares_px += std::pow(joint.residuals[i] * joint.cost.pairs.sigma_of(i), 2);
    sigma += joint.cost.pairs.sigma_of(i) * joint.cost.pair_sigma_scale;
  }
  const auto n = static_cast<double>(inliers.size());
  if (!evidence.boards.empty()) {  // of the corners; the pairs state their own
    const ReducedNormalEquations boards = board_equations(joint);
    summary.pixel_sigma_px = joint.boards.pixel_sigma_px;
    summary.rms_px = summary.pixel_sigma_px * std::sqrt(boards.chi2 / boards.residuals);
  } else if (n > 0) {
    summary.pixel_sigma_px = sigma / n;
    summary.rms_px = std::sqrt(squares_px / n);
  }
  double from_data =
      static_cast<double>(bound.rows()) + (joint.boards.warp == BoardWarp::free ? 2 : 0);
  if (plain.prior_information.size() > 0) from_data -= (bound * plain.prior_information).trace();
  summary.chi2 = plain.chi2;
  summary.dof = static_cast<int>(std::lround(plain.residuals - from_data -
                                             6 * static_cast<double>(joint.state.frames.size())));
  for (std::size_t i = 0; i < evidence.priors.size(); ++i) {
    const auto [chi2, dof] = of_held(evidence.priors[i], joint);
    summary.prior_chi2 += prior_chi2(joint.cost.priors[i], joint.state.rig) - chi2;
    summary.prior_dof += static_cast<int>(evidence.priors[i].covariance.names.size()) - dof;
  }
  return summary;
}

void warn(const JointCalibration& joint,
          const JointEvidence& evidence,
          const std::optional<PairChange>& change,
          const JointOptions& options,
          CalibrationSummary& summary) {
  // white noise leaves nothing to the scatter of image pairs, and so no change to the covariance
  const bool doubts_change = change && (change->is_doubtful() || options.white_noise);
  if (change) (doubts_change ? summary.trust_warnings : summary.warnings).push_back(change->text);
  const std::vector<int> lost = lost_image_pairs(evidence.pairs, summary.pair_outliers);
  const std::size_t pairs = evidence.pairs.size(), out = summary.pair_outliers.size();
  if (!lost.empty() && !doubts_change) {
    summary.trust_warnings.push_back(fmt::format(
        "most matches of image pair{} {} were left out as outliers: the rig was another there, or "
        "the matches are poor; look at these images, or leave them out",
        lost.size() > 1 ? "s" : "", fmt::join(lost, ", ")));
  } else if (3 * out > pairs && !doubts_change) {
    summary.trust_warnings.push_back(
        fmt::format("{} of {} pairs were left out as outliers: the matches are poor, or the rig "
                    "changed between image pairs",
                    out, pairs));
  } else if (out > 0) {
    summary.warnings.push_back(fmt::format("{} of {} pairs were left out as outliers", out, pairs));
  }
  if (joint.observability && static_cast<double>(pairs) < 3 * joint.observability->from_data) {
    summary.trust_warnings.push_back(
        fmt::format("{} pairs are few for the {:.1f} parameters they determine: neither their "
                    "noise nor outliers can be estimated; match more corners",
                    pairs, joint.observability->from_data));
  }
  const double scale = joint.pair_sigma_scale;
  const bool is_estimated = options.pair_sigma_scale == 0 && pairs > 0;
  if (is_estimated && scale > 2 && doubts_change) {
    summary.warnings.push_back(fmt::format(
        "the noise was estimated from the residuals, at {:.2g} times what is stated", scale));
  } else if (is_estimated && scale > 2) {
    constexpr double incredible = 5;
    (scale > incredible ? summary.trust_warnings : summary.warnings)
        .push_back(fmt::format("the residuals of the pairs are {:.2g} times their stated noise: "
                               "they are not from one rig, they conflict with the prior, or their "
                               "noise is larger; the noise was estimated from the residuals",
                               scale));
  } else if (is_estimated && scale < 0.5) {
    summary.warnings.push_back(
        fmt::format("the residuals of the pairs are {:.2g} times their stated noise; the noise was "
                    "estimated from the residuals",
                    scale));
  }
  if (summary.prior_dof > 0) {  // shrunk by the data's pull: no right prior exceeds it more often
    const double p = chi_squared_survival(summary.prior_chi2, summary.prior_dof);
    if (p < 1e-4) {
      summary.trust_warnings.push_back(
          fmt::format("data and prior are inconsistent (chi² {:.1f} for {}, p {:.1g}): the prior "
                      "is of another rig or understates its uncertainty, or the data are wrong",
                      summary.prior_chi2, summary.prior_dof, p));
    }
  }
  if (pairs > 0 && joint.estimate.covariance->kind == CovarianceKind::mvb && !options.white_noise) {
    summary.warnings.push_back(
        "fewer than three views: the covariance is the minimum variance bound, which is too small "
        "on real images");
  }
  if (joint.observability && joint.observability->is_prior_dominated()) {
    summary.warnings.push_back(fmt::format(
        "the result is dominated by what is known beside the pairs: they determine {:.1f} of {} "
        "parameters",
        std::max(0.0, joint.observability->from_data), joint.observability->directions.size()));
  }
}

}  // namespace vernier::internal
