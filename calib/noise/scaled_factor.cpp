// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/scaled_factor.h"

#include "calib/base/decompositions.h"
#include "calib/error.h"

namespace vernier::internal {

ScaledFactor::ScaledFactor(const Eigen::MatrixXd& S, const std::string& what)
    : scale_(S.diagonal().cwiseSqrt().cwiseInverse()),
      factor_(scale_.asDiagonal() * S * scale_.asDiagonal()) {
  if (!scale_.allFinite() || !factor_.is_positive_definite()) {
    throw Error("corner noise", what + " is not determined by the views", "give more views");
  }
}

double ScaledFactor::log_determinant() const {
  return 2 * (factor_.lower().diagonal().array().log().sum() - scale_.array().log().sum());
}

Eigen::VectorXd ScaledFactor::solve(const Eigen::VectorXd& b) const {
  return scale_.cwiseProduct(factor_.solve(Eigen::VectorXd(scale_.cwiseProduct(b))));
}

Eigen::MatrixXd ScaledFactor::solve(const Eigen::MatrixXd& B) const {
  return scale_.asDiagonal() * factor_.solve(Eigen::MatrixXd(scale_.asDiagonal() * B));
}

Eigen::MatrixXd ScaledFactor::inverse() const {
  return scale_.asDiagonal() * factor_.inverse() * scale_.asDiagonal();
}

Eigen::MatrixXd ScaledFactor::times_inverse_upper(const Eigen::MatrixXd& X) const {
  return factor_.times_inverse_upper(Eigen::MatrixXd(X * scale_.asDiagonal()));
}

}  // namespace vernier::internal
