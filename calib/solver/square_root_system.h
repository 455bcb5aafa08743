// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace vernier::internal {

/// The least-squares problem min Σ_f ‖A_f a + B_f b_f + r_f‖² of a linearised calibration in
/// triangular form: Householder QR of each frame's rows [B_f | A_f | r_f], then of the remaining
/// rows of all frames,
///
///     R_f b_f + N_f a + s_f = 0      one per frame
///     R a + s = 0                    the rig: RᵀR = S, the reduced information
///
/// No normal matrix is formed, so the error of S⁻¹ = R⁻¹ R⁻ᵀ grows with the condition of A and not
/// with its square, as in calib/solver/normal_equations.h. Rows are in units of the pixel noise.
class SquareRootSystem {
 public:
  explicit SquareRootSystem(int parameters);

  /// Rows [B | A | r] of one frame, 6 + parameters + 1 columns; they must determine the pose (at
  /// least six).
  void add_frame(const Eigen::MatrixXd& rows);
  /// Rows [A | r] that belong to no frame: a prior, or damping.
  void add_rows(const Eigen::MatrixXd& rows);

  /// −R⁻¹ s, the Gauss–Newton step, and the corresponding pose steps, six per frame.
  Eigen::VectorXd step() const;
  Eigen::VectorXd frame_steps(const Eigen::VectorXd& step) const;
  /// ‖s‖: the length of the step in standard deviations, all parameters together.
  double step_sigma() const { return rig_.rightCols<1>().norm(); }
  /// R⁻¹ R⁻ᵀ
  Eigen::MatrixXd covariance() const;

 private:
  Eigen::MatrixXd rig_;                                           ///< [R | s]
  std::vector<Eigen::Matrix<double, 6, Eigen::Dynamic>> frames_;  ///< [R_f | N_f | s_f]
};

}  // namespace vernier::internal
