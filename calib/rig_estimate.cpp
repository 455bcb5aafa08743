// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/rig_estimate.h"

#include "calib/error.h"

namespace vernier {

const Covariance& required_covariance(const RigEstimate& estimate, const std::string& place) {
  if (!estimate.covariance) {
    throw Error(place, "the rig has no covariance, so there is nothing to sample from",
                "calibrate it with vernier calibrate, or add parameter_names, parameters and "
                "covariance by hand");
  }
  return *estimate.covariance;
}

std::vector<Eigen::Index> free_parameters(const RigEstimate& estimate) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < parameter_count(estimate.rig); ++i) {
    if (!estimate.covariance || estimate.covariance->matrix(i, i) > 0) free.push_back(i);
  }
  return free;
}

}  // namespace vernier
