// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/covariance_check.h"

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/rig.h"

namespace vernier::internal {

void check_covariance(const Eigen::MatrixXd& matrix,
                      const std::vector<std::string>& names,
                      const std::string& place) {
  try {
    const ScaledDecomposition checked(Covariance{CovarianceKind::prior, names, matrix});
  } catch (const Error& error) {
    throw Error(place, error.fault(), error.remedy());
  }
}

void check_covariance(const Eigen::MatrixXd& matrix, const Rig& rig, const std::string& place) {
  if (matrix.rows() != parameter_count(rig) || matrix.cols() != matrix.rows()) {
    throw Error(place, "the covariance does not match the rig's parameters",
                "give one row and column per parameter");
  }
  check_covariance(matrix, parameter_names(rig), place);
}

void check_names(const Covariance& covariance, const Rig& rig, const std::string& place) {
  if (covariance.names == parameter_names(rig)) return;
  throw Error(place, "the covariance's names are not those of the rig's parameters",
              "give it in the order of parameter_names; rename cameras by rename_cameras");
}

}  // namespace vernier::internal
