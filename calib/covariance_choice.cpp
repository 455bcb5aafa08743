// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/covariance_choice.h"

#include "calib/error.h"

namespace vernier {

std::optional<Covariance> chosen_covariance(const RigEstimate& estimate, CovarianceChoice choice) {
  if (choice == CovarianceChoice::honest) return estimate.covariance;
  if (estimate.covariance_mvb) {
    return Covariance{CovarianceKind::mvb, parameter_names(estimate.rig), *estimate.covariance_mvb};
  }
  if (estimate.covariance && estimate.covariance->kind == CovarianceKind::mvb) {
    return estimate.covariance;
  }
  return std::nullopt;
}

Covariance required_covariance(const RigEstimate& estimate,
                               CovarianceChoice choice,
                               const std::string& place) {
  if (choice == CovarianceChoice::honest) return required_covariance(estimate, place);
  const std::optional<Covariance> chosen = chosen_covariance(estimate, choice);
  if (!chosen) {
    throw Error(place, "it has no minimum variance bound", "use the covariance it has");
  }
  return *chosen;
}

}  // namespace vernier
