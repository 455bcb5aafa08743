// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/mrcal/mrcal_problem.h"

namespace vernier {

/// The least-squares problem min ‖A a + B_f b_f + r‖² of a linearised calibration in triangular
/// form, by Householder's QR of each frame's rows [B_f | A | r] and then of what is left of all:
///
///     R_f b_f + N_f a + s_f = 0      one a frame
///     R a + s = 0                    the rig: S = RᵀR is the reduced information
///
/// No normal matrix is formed, so this shares neither code nor rounding with
/// calib/normal_equations.h.
struct SquareRootSystem {
  Eigen::MatrixXd R;
  Eigen::VectorXd s;
  std::vector<Eigen::Matrix<double, 6, Eigen::Dynamic>> frames;  ///< [R_f | N_f | s_f]

  /// −R⁻¹ s, and the pose steps that go with it.
  Eigen::VectorXd rig_step() const;
  Eigen::VectorXd frame_steps(const Eigen::VectorXd& rig_step) const;
  /// R⁻¹ R⁻ᵀ
  Eigen::MatrixXd covariance() const;
};

/// `lift` takes the free parameters to mrcal's states of the rig. With damping λ > 0 every unknown
/// has the further residual √λ times itself over its scale (`scales`: those of mrcal's states).
SquareRootSystem square_root_system(const MrcalEvaluation& evaluation,
                                    const std::vector<int>& frame_rows,
                                    const Eigen::MatrixXd& lift,
                                    const Eigen::VectorXd& scales,
                                    double damping = 0);

}  // namespace vernier
