// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/covariance_choice.h"

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

}  // namespace vernier
