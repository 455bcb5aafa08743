// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/square_root_system.h"

#include <utility>

#include "calib/base/decompositions.h"

namespace vernier::internal {
namespace {

/// The upper triangle of M's QR decomposition, square.
Eigen::MatrixXd triangle(Eigen::MatrixXd M) {
  const auto n = M.cols();
  if (M.rows() < n) {
    const auto given = M.rows();
    M.conservativeResize(n, n);
    M.bottomRows(n - given).setZero();
  }
  return qr_triangle(M);
}

}  // namespace

SquareRootSystem::SquareRootSystem(int parameters)
    : rig_(Eigen::MatrixXd::Zero(parameters, parameters + 1)) {}

void SquareRootSystem::add_frame(const Eigen::MatrixXd& rows) {
  const Eigen::MatrixXd T = triangle(rows);
  frames_.emplace_back(T.topRows<6>());
  add_rows(T.bottomRightCorner(rig_.cols(), rig_.cols()));
}

void SquareRootSystem::add_rows(const Eigen::MatrixXd& rows) {
  Eigen::MatrixXd both(rig_.rows() + rows.rows(), rig_.cols());
  both << rig_, rows;
  rig_ = triangle(std::move(both)).topRows(rig_.rows());
}

Eigen::VectorXd SquareRootSystem::step() const {
  const auto p = rig_.rows();
  return -rig_.leftCols(p).triangularView<Eigen::Upper>().solve(rig_.col(p));
}

Eigen::VectorXd SquareRootSystem::frame_steps(const Eigen::VectorXd& step) const {
  Eigen::VectorXd steps(6 * static_cast<Eigen::Index>(frames_.size()));
  Eigen::Index at = 0;
  for (const auto& T : frames_) {
    const Eigen::Matrix<double, 6, 1> right =
        -(T.rightCols<1>() + T.middleCols(6, rig_.rows()) * step);
    steps.segment<6>(at) = T.leftCols<6>().triangularView<Eigen::Upper>().solve(right);
    at += 6;
  }
  return steps;
}

Eigen::MatrixXd SquareRootSystem::covariance() const {
  const auto p = rig_.rows();
  const Eigen::MatrixXd inverse =
      rig_.leftCols(p).triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(p, p));
  return inverse * inverse.transpose();
}

}  // namespace vernier::internal
