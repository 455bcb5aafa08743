// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/covariance_estimators.h"

#include <fmt/format.h>
#include <Eigen/LU>
#include <cmath>

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

Eigen::MatrixXd clustered_sandwich(const ReducedNormalEquations& equations,
                                   const Eigen::MatrixXd& bound,
                                   double frames_per_parameter) {
  const auto frames = static_cast<double>(equations.scores.cols());
  const auto parameters = static_cast<double>(bound.rows());
  if (frames < frames_per_parameter * parameters) {
    throw Error("clustered covariance",
                fmt::format("{} frames are too few for {} parameters", frames, parameters),
                fmt::format("give at least {}", std::ceil(frames_per_parameter * parameters)));
  }
  if (equations.prior_information.size() == 0) {
    const Eigen::MatrixXd influence = bound * equations.scores;
    return frames / (frames - 1) * influence * influence.transpose();
  }
  // With a prior, the scores sum to its gradient, which is no scatter, and it adds its own
  // information.
  const Eigen::MatrixXd centred =
      equations.scores.colwise() - equations.scores.rowwise().mean().eval();
  const Eigen::MatrixXd influence = bound * centred;
  return frames / (frames - 1) * influence * influence.transpose() +
         bound * equations.prior_information * bound;
}

}  // namespace vernier::internal
