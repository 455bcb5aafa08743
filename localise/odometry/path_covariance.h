// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <map>
#include <span>

#include "calib/pose.h"
#include "localise/odometry.h"
#include "localise/odometry/step_refinement.h"

namespace vernier::localise::internal {

/// Derivatives of a product of poses T = A B in the tangent of retract().
struct ProductDerivatives {
  Eigen::Matrix<double, 6, 6> by_first = Eigen::Matrix<double, 6, 6>::Identity();
  Eigen::Matrix<double, 6, 6> by_second = Eigen::Matrix<double, 6, 6>::Zero();

  ProductDerivatives(const Pose& A, const Pose& B);
};

/// Covariance of the end of a path from the noise of its corners, step by step.
///
/// Successive steps share the corners of a moment, and what these do to the one they partly undo in
/// the other: the covariances of the steps alone do not add up to that of the end. So what a corner
/// does to the end is summed first, over both steps for the noise as it is stated and over all
/// steps that follow the corner for its residuals (a cluster-robust sandwich: Liang and Zeger,
/// Biometrika 73, 1986), and then squared. Of one step it is MotionStep::covariance.
class PathCovariance {
 public:
  /// Adds a step of which `d` are the derivatives of the path's new end by the end before and by
  /// the step.
  void add(const ProductDerivatives& d,
           std::span<const CornerLink> inliers,
           std::span<const CornerInfluence> influences);

  Eigen::Matrix<double, 6, 6> covariance() const;

 private:
  /// What a corner of the last moment has done to the end so far.
  struct FollowedCorner {
    Eigen::Matrix<double, 6, 4> noise;
    Eigen::Matrix<double, 6, 1> residual;

    Eigen::Matrix<double, 6, 6> squared() const;
  };

  Eigen::Matrix<double, 6, 6> closed_ = Eigen::Matrix<double, 6, 6>::Zero();
  std::map<int, FollowedCorner> followed_;  // by their index at the last moment
};

}  // namespace vernier::localise::internal
