// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/dense_likelihood.h"

#include <Eigen/Cholesky>
#include <cstddef>
#include <utility>

#include "calib/noise/corner_covariance.h"

namespace vernier::test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Of a positive definite matrix, scaled to a unit diagonal first.
struct Scaled {
  VectorXd scale;
  Eigen::LLT<MatrixXd> factor;

  explicit Scaled(const MatrixXd& A)
      : scale(A.diagonal().cwiseSqrt().cwiseInverse()),
        factor(MatrixXd(scale.asDiagonal() * A * scale.asDiagonal())) {}
  double log_determinant() const {
    return 2 *
           (MatrixXd(factor.matrixL()).diagonal().array().log().sum() - scale.array().log().sum());
  }
  MatrixXd solve(const MatrixXd& B) const {
    return scale.asDiagonal() * factor.solve(MatrixXd(scale.asDiagonal() * B));
  }
};

}  // namespace

DenseLikelihood::DenseLikelihood(std::vector<vernier::internal::FrameRows> frames,
                                 std::vector<Eigen::Vector3d> target_m)
    : frames_(std::move(frames)), target_m_(std::move(target_m)) {
  Index rows = 0;
  for (const auto& f : frames_) {
    first_.push_back(rows);
    rows += f.residual_px.size();
  }
  const Index rig = frames_[0].by_rig.cols();
  X_ = MatrixXd::Zero(rows, rig + 6 * static_cast<Index>(frames_.size()));
  D_ = MatrixXd::Zero(rows, 3 * static_cast<Index>(target_m_.size()));
  r_.resize(rows);
  for (std::size_t k = 0; k < frames_.size(); ++k) {
    const auto& f = frames_[k];
    const Index at = first_[k], n = f.residual_px.size();
    X_.block(at, 0, n, rig) = f.by_rig;
    X_.block(at, rig + 6 * static_cast<Index>(k), n, 6) = f.by_pose;
    r_.segment(at, n) = f.residual_px;
    for (const auto& view : f.views) {
      const auto corners = static_cast<Index>(view.ids.size());
      for (Index row = 0; row < 2 * corners; ++row) {
        const int id = view.ids[static_cast<std::size_t>(row % corners)];
        D_.block<1, 3>(at + view.first + row, 3 * id) = f.by_point.row(view.first + row);
      }
    }
  }
}

MatrixXd DenseLikelihood::V(const vernier::internal::CornerNoise& noise) const {
  VectorXd b(D_.cols());
  for (Index i = 0; i < b.size(); ++i)
    b[i] = i % 3 < 2 ? noise.shape_plane_m : noise.shape_height_m;
  MatrixXd V = D_ * b.cwiseAbs2().asDiagonal() * D_.transpose();
  for (std::size_t k = 0; k < frames_.size(); ++k) {
    const Index n = frames_[k].residual_px.size();
    V.block(first_[k], first_[k], n, n) += corner_covariance(frames_[k], noise, target_m_);
  }
  return V;
}

MatrixXd DenseLikelihood::P(const vernier::internal::CornerNoise& noise) const {
  const Scaled of_V(V(noise));
  const MatrixXd ViX = of_V.solve(X_);
  return of_V.solve(MatrixXd::Identity(r_.size(), r_.size())) -
         ViX * Scaled(X_.transpose() * ViX).solve(ViX.transpose());
}

double DenseLikelihood::minus_two_log(const vernier::internal::CornerNoise& noise) const {
  const Scaled of_V(V(noise)), of_X(X_.transpose() * of_V.solve(X_));
  return of_V.log_determinant() + of_X.log_determinant() + r_.dot(P(noise) * r_);
}

MatrixXd DenseLikelihood::by_motion(std::size_t frame) const {
  const auto& f = frames_[frame];
  MatrixXd M = MatrixXd::Zero(r_.size(), f.by_motion.cols());
  M.middleRows(first_[frame], f.residual_px.size()) = f.by_motion;
  return M;
}

}  // namespace vernier::test
