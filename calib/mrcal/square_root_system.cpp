// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/mrcal/square_root_system.h"

#include <Eigen/QR>
#include <cmath>

namespace vernier {
namespace {

/// Rows of one frame, [B | A | r]; zero rows (corners not seen) are left out.
Eigen::MatrixXd frame_rows_of(
    const MrcalEvaluation& e, int begin, int end, int frame_state, const Eigen::MatrixXd& lift) {
  const auto p = lift.cols();
  Eigen::MatrixXd rows(end - begin, 6 + p + 1);
  Eigen::Index used = 0;
  for (int row = begin; row < end; ++row) {
    auto out = rows.row(used);
    out.setZero();
    bool seen = false;
    for (int k = e.row_start[row]; k < e.row_start[row + 1]; ++k) {
      const int state = e.state[k];
      seen = seen || e.value[k] != 0;
      if (state >= lift.rows()) {
        out[state - frame_state] = e.value[k];
      } else {
        out.segment(6, p) += e.value[k] * lift.row(state);
      }
    }
    out[6 + p] = e.residual_px[row];
    if (seen) ++used;
  }
  return rows.topRows(used);
}

/// The upper triangle of M's QR decomposition, square.
Eigen::MatrixXd triangle(const Eigen::MatrixXd& M) {
  const auto n = M.cols();
  Eigen::MatrixXd padded = M;
  if (M.rows() < n) {
    padded = Eigen::MatrixXd::Zero(n, n);
    padded.topRows(M.rows()) = M;
  }
  return Eigen::HouseholderQR<Eigen::MatrixXd>(padded)
      .matrixQR()
      .topRows(n)
      .triangularView<Eigen::Upper>();
}

Eigen::MatrixXd stacked(const Eigen::MatrixXd& above, const Eigen::MatrixXd& below) {
  Eigen::MatrixXd both(above.rows() + below.rows(), above.cols());
  both << above, below;
  return both;
}

/// 1 / scale of each free parameter: that of the first state it moves.
Eigen::VectorXd inverse_scales(const Eigen::MatrixXd& lift, const Eigen::VectorXd& scales) {
  Eigen::VectorXd inverse(lift.cols());
  for (Eigen::Index j = 0; j < lift.cols(); ++j) {
    Eigen::Index state = 0;
    lift.col(j).cwiseAbs().maxCoeff(&state);
    inverse[j] = 1 / scales[state];
  }
  return inverse;
}

}  // namespace

SquareRootSystem square_root_system(const MrcalEvaluation& evaluation,
                                    const std::vector<int>& frame_rows,
                                    const Eigen::MatrixXd& lift,
                                    const Eigen::VectorXd& scales,
                                    double damping) {
  const auto p = lift.cols();
  const auto frames = static_cast<int>(frame_rows.size()) - 1;
  SquareRootSystem system;
  Eigen::MatrixXd rig = Eigen::MatrixXd::Zero(p, p + 1);
  const double root = std::sqrt(damping);
  rig.leftCols(p).diagonal() = root * inverse_scales(lift, scales);
  for (int f = 0; f < frames; ++f) {
    const auto frame_state = lift.rows() + 6 * f;
    Eigen::MatrixXd M = frame_rows_of(evaluation, frame_rows[f], frame_rows[f + 1],
                                      static_cast<int>(frame_state), lift);
    if (damping > 0) {
      Eigen::MatrixXd damped = Eigen::MatrixXd::Zero(6, M.cols());
      damped.leftCols(6).diagonal() = root * scales.segment<6>(frame_state).cwiseInverse();
      M = stacked(M, damped);
    }
    const Eigen::MatrixXd T = triangle(M);
    system.frames.emplace_back(T.topRows<6>());
    rig = triangle(stacked(rig, T.bottomRightCorner(p + 1, p + 1)));
  }
  system.R = rig.topLeftCorner(p, p);
  system.s = rig.col(p).head(p);
  return system;
}

Eigen::VectorXd SquareRootSystem::rig_step() const {
  return -R.triangularView<Eigen::Upper>().solve(s);
}

Eigen::VectorXd SquareRootSystem::frame_steps(const Eigen::VectorXd& step) const {
  Eigen::VectorXd steps(6 * frames.size());
  const auto p = R.cols();
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const auto& T = frames[f];
    const Eigen::Matrix<double, 6, 1> right = -(T.col(6 + p) + T.middleCols(6, p) * step);
    steps.segment<6>(6 * static_cast<Eigen::Index>(f)) =
        T.leftCols<6>().triangularView<Eigen::Upper>().solve(right);
  }
  return steps;
}

Eigen::MatrixXd SquareRootSystem::covariance() const {
  const Eigen::MatrixXd inverse =
      R.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(R.rows(), R.cols()));
  return inverse * inverse.transpose();
}

}  // namespace vernier
