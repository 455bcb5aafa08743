// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/combine_evidence.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/combine.h"
#include "calib/estimate/held_parameters.h"
#include "calib/joint_calibration.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"

namespace vernier::internal {
namespace {

/// Whether the priors are equal up to the rounding of a file.
bool same(const GaussianRigPrior& a, const GaussianRigPrior& b) {
  constexpr double rounding = 1e-9;
  if (a.covariance.names != b.covariance.names) return false;
  if (parameter_names(a.rig) != parameter_names(b.rig)) return false;
  const Eigen::MatrixXd &A = a.covariance.matrix, &B = b.covariance.matrix;
  const Eigen::VectorXd sd = A.diagonal().cwiseSqrt();
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    for (Eigen::Index k = 0; k < A.cols(); ++k) {
      if (std::abs(A(i, k) - B(i, k)) > rounding * sd[i] * sd[k]) return false;
    }
  }
  const std::vector<std::string> all = parameter_names(a.rig);
  const Eigen::VectorXd x = parameters(a.rig), y = parameters(b.rig);
  for (const std::string& name : a.covariance.names) {  // the others are not covered
    const auto i = std::find(all.begin(), all.end(), name) - all.begin();
    if (!(std::abs(x[i] - y[i]) <= rounding * (1e-3 + std::abs(x[i])))) return false;
  }
  return true;
}

}  // namespace

bool has_boards(const RigEstimate& estimate) {
  return estimate.evidence && !estimate.evidence->observations.views.empty();
}
bool has_pairs(const RigEstimate& estimate) {
  return estimate.evidence && estimate.evidence->pairs.size() > 0;
}

JointEvidence evidence_of(const CombineInput& input) {
  JointEvidence evidence;
  if (!input.estimate) {
    evidence.pairs = input.pairs;
    return evidence;
  }
  const RigEstimate& estimate = *input.estimate;
  if (has_boards(estimate)) {
    CalibrationEvidence boards = *estimate.evidence;
    boards.pairs = {};
    boards.priors.clear();
    if (estimate.calibration && estimate.calibration->effects) {
      boards.warp_m.setZero();  // it was estimated as a part of the shape
    }
    const double sigma = estimate.calibration ? estimate.calibration->pixel_sigma_px : 1;
    evidence.boards.push_back({std::move(boards), sigma});
  }
  if (has_pairs(estimate)) evidence.pairs = estimate.evidence->pairs;
  if (estimate.evidence) evidence.priors = estimate.evidence->priors;
  if (!has_boards(estimate) && !has_pairs(estimate)) {
    evidence.priors = {gaussian_prior_of(estimate, input.name)};
  }
  return evidence;
}

std::vector<GaussianRigPrior> new_priors(const std::vector<GaussianRigPrior>& so_far,
                                         const std::vector<GaussianRigPrior>& more) {
  std::vector<GaussianRigPrior> added;
  for (const GaussianRigPrior& prior : more) {
    const auto is_same = [&](const GaussianRigPrior& p) { return same(p, prior); };
    if (std::none_of(so_far.begin(), so_far.end(), is_same)) added.push_back(prior);
  }
  return added;
}

JointOptions with_held(JointOptions options, const CombineInput& first) {
  if (!first.estimate) return options;
  for (const HeldParameter& held : held_by(gaussian_prior_of(*first.estimate, first.name))) {
    options.held.push_back(held);
  }
  return options;
}

std::vector<JointEvidence> evidence_of_all(const std::vector<CombineInput>& inputs) {
  std::vector<GaussianRigPrior> calibrations;
  std::vector<JointEvidence> all;
  for (const CombineInput& input : inputs) {
    all.push_back(evidence_of(input));
    const bool prior_only = all.back().boards.empty() && all.back().pairs.size() == 0;
    if (input.estimate && input.estimate->covariance && !prior_only) {
      calibrations.push_back(gaussian_prior_of(*input.estimate, input.name));
    }
  }
  for (JointEvidence& evidence : all) {
    std::erase_if(evidence.priors, [&](const GaussianRigPrior& prior) {
      return std::any_of(calibrations.begin(), calibrations.end(),
                         [&](const GaussianRigPrior& c) { return same(c, prior); });
    });
  }
  return all;
}

}  // namespace vernier::internal
