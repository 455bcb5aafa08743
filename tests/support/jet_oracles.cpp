// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/jet_oracles.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <vector>

#include "calib/camera.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"

namespace vernier::test {
namespace {

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

/// Reprojection residuals of one match with its point as an unknown.
struct BundleResidual {
  Eigen::Vector4d y;
  double sigma;
  Eigen::Matrix3d R;
  template <class T>
  bool operator()(const T* a, const T* X, T* residual) const {
    T delta[9];
    ceres::AngleAxisToRotationMatrix(a + 10, ceres::RowMajorAdapter3x3(delta));
    const Eigen::Matrix<T, 3, 3> Rt =
        Eigen::Map<const Eigen::Matrix<T, 3, 3, Eigen::RowMajor>>(delta) * R.cast<T>();
    // (x / z, y / z, 1 / z) in the left frame.
    const Eigen::Matrix<T, 3, 1> left(X[0], X[1], T(1.0));
    const Eigen::Matrix<T, 3, 1> t(a[13], a[14], a[15]);
    const Eigen::Matrix<T, 3, 1> right = Rt * left + t * X[2];
    for (int c = 0; c < 2; ++c) {
      const T* p = a + 5 * c;
      const T u = c == 0 ? X[0] : right[0] / right[2], v = c == 0 ? X[1] : right[1] / right[2];
      const T g = T(1.0) + p[4] * (u * u + v * v);
      residual[2 * c] = (p[0] * p[1] * u * g + p[2] - y[2 * c]) / sigma;
      residual[2 * c + 1] = (p[0] * v * g + p[3] - y[2 * c + 1]) / sigma;
    }
    return true;
  }
};

}  // namespace

Rig solve_by_jets(const PairObservations& pairs, const RigPrior& prior, const Rig& start) {
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

Rig bundle_adjusted(const PairObservations& pairs, const RigPrior& prior, const Rig& start) {
  Eigen::VectorXd a = parameters(start);
  a.segment<3>(10).setZero();
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector4d& y : pairs.pixels_px) {
    const Eigen::Vector3d ray = unproject(start.cameras[0], y.head<2>());
    points.emplace_back(ray.x(), ray.y(), 0.2);
  }
  ceres::Problem problem;
  auto* ordering = new ceres::ParameterBlockOrdering;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<BundleResidual, 4, 16, 3>(
            new BundleResidual{pairs.pixels_px[i], pairs.sigma_of(i), start.T_camera_first[1].R}),
        nullptr, a.data(), points[i].data());
    ordering->AddElementToGroup(points[i].data(), 0);
  }
  ordering->AddElementToGroup(a.data(), 1);
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<JetPrior, 16, 16>(
                               new JetPrior{a, prior.information.diagonal().cwiseSqrt()}),
                           nullptr, a.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.linear_solver_ordering.reset(ordering);
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-16;
  options.parameter_tolerance = 1e-13;
  options.gradient_tolerance = 1e-13;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  Eigen::VectorXd delta = a - parameters(start);
  delta.segment<3>(10) = a.segment<3>(10);
  return retract(start, delta);
}

}  // namespace vernier::test
