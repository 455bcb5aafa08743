// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/minimum_variance_bound.h"

#include <Eigen/LU>

#include "calib/base/decompositions.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/solver/normal_equations.h"

namespace vernier::internal {

Eigen::MatrixXd minimum_variance_bound(const ReducedNormalEquations& equations,
                                       const std::vector<std::string>& names) {
  // Scaled by the information with known board poses: a direction that the poses can imitate then
  // has a small eigenvalue, whatever the units of its parameters.
  const Eigen::VectorXd& diagonal = equations.held_poses_diagonal;
  for (Eigen::Index i = 0; i < diagonal.size(); ++i) {
    if (!(diagonal[i] > 0)) {
      throw Error(names[i], "the observations do not constrain it", "add views that do");
    }
  }
  const Eigen::VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * equations.information * scale.asDiagonal();
  const SymmetricEigen eigen(scaled);
  if (!(eigen.eigenvalues()[0] > 1e-13 * eigen.eigenvalues()[diagonal.size() - 1])) {
    throw Error("calibration",
                "the views leave a direction undetermined: " +
                    describe_direction(eigen.eigenvectors().col(0), names),
                "add views at other tilts and distances, or use a model with fewer parameters");
  }
  const Eigen::MatrixXd inverse = Cholesky(scaled).inverse();
  const Eigen::MatrixXd C = scale.asDiagonal() * inverse * scale.asDiagonal();
  return 0.5 * (C + C.transpose());
}

}  // namespace vernier::internal
