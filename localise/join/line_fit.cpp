// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/join/line_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "calib/pose.h"
#include "localise/joined_lines.h"

namespace vernier::localise::internal {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;
using Eigen::Vector4d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

bool is_semidefinite(const Matrix6d& covariance_m2) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(covariance_m2, Eigen::EigenvaluesOnly);
  const auto& values = solver.eigenvalues();
  return values[0] >= -1e-9 * values[5] && values[5] > 0;
}

WorldSighting in_world(const SightedSegment& segment, const Pose& T, const JoinOptions& options) {
  WorldSighting sighting;
  sighting.a_m = T * segment.a_m;
  sighting.b_m = T * segment.b_m;
  Matrix6d R = Matrix6d::Zero(), J;  // J: by the turn of the view, and its place
  R.topLeftCorner<3, 3>() = R.bottomRightCorner<3, 3>() = T.R;
  J << -hat(T.R * segment.a_m), Matrix3d::Identity(), -hat(T.R * segment.b_m), Matrix3d::Identity();
  const double turn2 = options.view_turn_rad * options.view_turn_rad;
  const double place2 = options.view_position_m * options.view_position_m;
  Eigen::Matrix<double, 6, 1> variances;
  variances << turn2, turn2, turn2, place2, place2, place2;
  sighting.covariance_m2 =
      R * segment.covariance_m2 * R.transpose() + J * variances.asDiagonal() * J.transpose();
  return sighting;
}

void make_definite(WorldSighting& sighting) {
  constexpr double least_m = 1e-5;
  sighting.covariance_m2.diagonal().array() += least_m * least_m;
}

double sigma_across(const WorldSighting& sighting) {
  const LineFrame frame = frame_of(sighting.a_m, sighting.b_m);
  double most = 0;
  for (int end = 0; end < 2; ++end) {
    const auto xy = frame.axes.leftCols<2>();
    const Eigen::Matrix2d C =
        xy.transpose() * sighting.covariance_m2.block<3, 3>(3 * end, 3 * end) * xy;
    // the larger eigenvalue
    most = std::max(most, 0.5 * C.trace() + std::hypot(0.5 * (C(0, 0) - C(1, 1)), C(0, 1)));
  }
  return std::sqrt(most);
}

LineFrame frame_of(const Vector3d& a_m, const Vector3d& b_m) {
  LineFrame frame;
  frame.origin_m = 0.5 * (a_m + b_m);
  frame.axes.col(2) = (b_m - a_m).normalized();
  frame.axes.col(0) = frame.axes.col(2).unitOrthogonal();
  frame.axes.col(1) = frame.axes.col(2).cross(frame.axes.col(0));
  return frame;
}

Matrix4d LineMeasurement::by_line() const {
  Matrix4d H = Matrix4d::Zero();
  for (int end = 0; end < 2; ++end) {
    H.block<2, 2>(2 * end, 0) = Eigen::Matrix2d::Identity();
    H.block<2, 2>(2 * end, 2) = station_m[end] * Eigen::Matrix2d::Identity();
  }
  return H;
}

LineMeasurement measured(const WorldSighting& sighting, const LineFrame& frame) {
  LineMeasurement m;
  m.across_m << frame.across(sighting.a_m), frame.across(sighting.b_m);
  m.station_m = {frame.station(sighting.a_m), frame.station(sighting.b_m)};
  Eigen::Matrix<double, 4, 6> P = Eigen::Matrix<double, 4, 6>::Zero();
  P.topLeftCorner<2, 3>() = P.bottomRightCorner<2, 3>() = frame.axes.leftCols<2>().transpose();
  m.covariance_m2 = P * sighting.covariance_m2 * P.transpose();
  return m;
}

FittedLine fitted(std::span<const WorldSighting* const> sightings) {
  // begin with the longest
  const WorldSighting* longest = *std::max_element(
      sightings.begin(), sightings.end(), [](const WorldSighting* a, const WorldSighting* b) {
        return (a->b_m - a->a_m).squaredNorm() < (b->b_m - b->a_m).squaredNorm();
      });
  FittedLine line;
  line.frame = frame_of(longest->a_m, longest->b_m);
  constexpr int most_steps = 5;
  for (int step = 0; step < most_steps; ++step) {
    line.information.setZero();
    Vector4d right = Vector4d::Zero();
    for (const WorldSighting* sighting : sightings) {
      const LineMeasurement m = measured(*sighting, line.frame);
      const Matrix4d H = m.by_line();
      const Eigen::LLT<Matrix4d> C(m.covariance_m2);
      line.information += H.transpose() * C.solve(H);
      right += H.transpose() * C.solve(m.across_m);
    }
    const Eigen::LLT<Matrix4d> solver(line.information);
    line.covariance = solver.solve(Matrix4d::Identity());
    const Vector4d theta = solver.solve(right);
    const Vector3d o = line.frame.origin_m + line.frame.axes.leftCols<2>() * theta.head<2>();
    const Vector3d d = line.frame.axes.col(2) + line.frame.axes.leftCols<2>() * theta.tail<2>();
    // turn the axes along, so that θ keeps its meaning to first order
    const Vector3d z = d.normalized();
    line.frame.origin_m = o;
    line.frame.axes.col(0) =
        (line.frame.axes.col(0) - z * z.dot(line.frame.axes.col(0))).normalized();
    line.frame.axes.col(2) = z;
    line.frame.axes.col(1) = z.cross(line.frame.axes.col(0));
    if (theta.head<2>().norm() < 1e-7 && theta.tail<2>().norm() < 1e-7) break;
  }
  return line;
}

Matrix6d covariance_of_ends(const FittedLine& line,
                            double low_m,
                            double high_m,
                            const std::array<double, 2>& along_m2) {
  LineMeasurement at;
  at.station_m = {low_m, high_m};
  Eigen::Matrix<double, 6, 4> J = Eigen::Matrix<double, 6, 4>::Zero();
  J.topLeftCorner<3, 2>() = J.bottomRightCorner<3, 2>() = line.frame.axes.leftCols<2>();
  J *= at.by_line();
  Matrix6d C = J * line.covariance * J.transpose();
  const Vector3d z = line.frame.axes.col(2);
  for (int end = 0; end < 2; ++end) {
    C.block<3, 3>(3 * end, 3 * end) += along_m2[end] * z * z.transpose();
  }
  return C;
}

LineDistance distance(const LineMeasurement& m, const FittedLine& line) {
  const Matrix4d H = m.by_line();
  const Eigen::LLT<Matrix4d> S(m.covariance_m2 + H * line.covariance * H.transpose());
  LineDistance d;
  d.mahalanobis2 = m.across_m.dot(S.solve(m.across_m));
  d.cost = d.mahalanobis2;
  for (int i = 0; i < 4; ++i) d.cost += 2 * std::log(S.matrixLLT()(i, i));
  return d;
}

double residual2(const LineMeasurement& m) {
  return m.across_m.dot(m.covariance_m2.llt().solve(m.across_m));
}

}  // namespace vernier::localise::internal
