// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/result_checks.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/opencv_models.h"
#include "calib/prior_consistency.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"

namespace vernier::internal {

std::optional<std::string> ill_conditioning_warning(const Covariance& bound, const Rig& rig) {
  if (bound.matrix.rows() == 0) return {};
  double condition = INFINITY;
  std::string words;
  try {
    const ScaledDecomposition decomposition(bound);
    condition = decomposition.scaled_condition();
    words = decomposition.directions().front().description;
  } catch (const Error&) {  // not even positive any more
  }
  if (condition <= largest_scaled_condition) return {};
  const bool richest = std::any_of(
      rig.cameras.begin(), rig.cameras.end(),
      [](const Camera& camera) { return std::holds_alternative<OpenCv8>(camera.model); });
  return fmt::format(
      "the views hardly determine this model: its parameters' scaled condition is {:.1e}{}, so "
      "that the standard deviations say too little; {}",
      condition, words.empty() ? "" : " (" + words + ")",
      richest ? "use --model opencv5"
              : "use a model with fewer parameters, or add tilted views that fill the image");
}

std::optional<std::string> prior_conflict_warning(const RigPrior& prior,
                                                  const Rig& rig,
                                                  const Eigen::MatrixXd& bound,
                                                  const Eigen::MatrixXd& honest,
                                                  int clusters) {
  constexpr double min_p = 1e-4;
  std::vector<Eigen::Index> known;
  for (Eigen::Index i = 0; i < bound.rows(); ++i) {
    if (prior.information(i, i) > 0 && bound(i, i) > 0) known.push_back(i);
  }
  if (known.empty()) return {};
  std::vector<std::string> names;
  for (const Eigen::Index i : known) names.push_back(parameter_names(rig)[i]);
  const Eigen::VectorXd offset = difference(rig, prior.mean)(known);
  const Eigen::MatrixXd before = prior.information(known, known).inverse();
  PriorConsistency agreement;
  try {
    agreement = prior_consistency(offset, names, before, bound(known, known), honest(known, known),
                                  clusters);
  } catch (const Error&) {  // a prior that no double can invert says nothing here
    return {};
  }
  if (agreement.dof == 0 || agreement.p_value >= min_p) return {};
  Eigen::Index most = 0;
  const double sigmas = (offset.array() / before.diagonal().array().sqrt()).abs().maxCoeff(&most);
  return fmt::format(
      "data and prior disagree: {} moved by {:.1f} of its prior's standard deviations (p = {:.1e} "
      "over {} direction{}); check the prior's value, or give it a larger standard deviation",
      names[most], sigmas, agreement.p_value, agreement.dof, agreement.dof == 1 ? "" : "s");
}

}  // namespace vernier::internal
