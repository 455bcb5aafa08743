// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"

namespace vernier::test {

/// The Sampson residual of a `radial1` pair written plainly on any number type, for Ceres'
/// automatic differentiation: an oracle and a peer, sharing nothing with the kernels. Parameters
/// are the rig's 16, the rotation as a left tangent about `R`.
struct JetSampson {
  Eigen::Vector4d y;
  double sigma;
  Eigen::Matrix3d R;

  template <class T>
  static void undistort(const T& xd, const T& yd, const T& k, T& x, T& y) {
    T scale(1.0);
    const T r2 = xd * xd + yd * yd;
    for (int round = 0; round < 12; ++round) {  // scale (1 + k r² scale²) = 1
      const T q = k * r2 * scale * scale;
      scale = scale - (scale * (T(1.0) + q) - T(1.0)) / (T(1.0) + T(3.0) * q);
    }
    x = xd * scale;
    y = yd * scale;
  }

  template <class T>
  bool operator()(const T* a, T* residual) const {
    T x[2], v[2];
    for (int c = 0; c < 2; ++c) {
      const T* p = a + 5 * c;
      undistort((T(y[2 * c]) - p[2]) / (p[0] * p[1]), (T(y[2 * c + 1]) - p[3]) / p[0], p[4], x[c],
                v[c]);
    }
    T delta[9];
    ceres::AngleAxisToRotationMatrix(a + 10, ceres::RowMajorAdapter3x3(delta));
    const Eigen::Matrix<T, 3, 3> Rt =
        Eigen::Map<const Eigen::Matrix<T, 3, 3, Eigen::RowMajor>>(delta) * R.cast<T>();
    const Eigen::Matrix<T, 3, 1> t(a[13], a[14], a[15]);
    const Eigen::Matrix<T, 3, 1> left(x[0], v[0], T(1.0)), right(x[1], v[1], T(1.0));
    const Eigen::Matrix<T, 3, 1> by_right = t.cross(Eigen::Matrix<T, 3, 1>(Rt * left));
    const Eigen::Matrix<T, 3, 1> by_left = Rt.transpose() * Eigen::Matrix<T, 3, 1>(right.cross(t));
    T variance(0.0);
    for (int c = 0; c < 2; ++c) {
      const Eigen::Matrix<T, 3, 1>& l = c == 0 ? by_left : by_right;
      const T* p = a + 5 * c;
      const T r2 = x[c] * x[c] + v[c] * v[c], g = T(1.0) + p[4] * r2, bend = T(2.0) * p[4];
      // Inverse of A = g I + 2 k X Xᵀ by Sherman and Morrison.
      const T along = bend * (x[c] * l[0] + v[c] * l[1]) / (g * (g + bend * r2));
      const T gx = (l[0] / g - along * x[c]) / (p[0] * p[1]);
      const T gy = (l[1] / g - along * v[c]) / p[0];
      variance += gx * gx + gy * gy;
    }
    residual[0] = right.dot(by_right) / (T(sigma) * sqrt(variance));
    return true;
  }
};

/// A diagonal prior about the start, whose rotation is the tangent's origin.
struct JetPrior {
  Eigen::VectorXd mean, half;  // half the information's root
  template <class T>
  bool operator()(const T* a, T* residual) const {
    for (int i = 0; i < 16; ++i) residual[i] = T(half[i]) * (a[i] - T(mean[i]));
    return true;
  }
};

/// Minimum of the unified cost from `start`, where the prior's mean stands too.
inline Rig solve_by_jets(const PairObservations& pairs, const RigPrior& prior, const Rig& start) {
  Eigen::VectorXd a = parameters(start);
  a.segment<3>(10).setZero();
  ceres::Problem problem;
  const Eigen::Matrix3d R = start.T_camera_first[1].R;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<JetSampson, 1, 16>(
                                 new JetSampson{pairs.pixels_px[i], pairs.sigma_of(i), R}),
                             nullptr, a.data());
  }
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<JetPrior, 16, 16>(
                               new JetPrior{a, prior.information.diagonal().cwiseSqrt()}),
                           nullptr, a.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.function_tolerance = 1e-16;
  options.parameter_tolerance = 1e-14;
  options.gradient_tolerance = 1e-14;
  options.initial_trust_region_radius = 1e12;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  Eigen::VectorXd delta = a - parameters(start);
  delta.segment<3>(10) = a.segment<3>(10);
  return retract(start, delta);
}

}  // namespace vernier::test
