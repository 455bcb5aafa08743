// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/pose.h"

#include <gtest/gtest.h>

#include "tests/support/numeric_jacobian.h"

namespace vernier {
namespace {

const Eigen::Vector3d rotations[] = {
    {0, 0, 0}, {1e-10, -1e-9, 0}, {0.3, -0.2, 0.9}, {2.0, 1.5, -1.5}, {3.1415, 0, 0}};

TEST(Pose, RotationVectorRoundTrip) {
  for (const auto& w : rotations) {
    const Eigen::Matrix3d R = rotation_from_vector(w);
    EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    EXPECT_LT((vector_from_rotation(R) - w).norm(), 1e-11);
  }
}

TEST(Pose, LeftJacobianTakesAdditiveChangesToTheTangent) {
  for (const auto& w : rotations) {
    const Eigen::Matrix3d R = rotation_from_vector(w);
    const auto J = test::numeric_jacobian(
        [&](const Eigen::VectorXd& v) -> Eigen::VectorXd {
          return vector_from_rotation(rotation_from_vector(v) * R.transpose());
        },
        w);
    EXPECT_LT((J - left_jacobian(w)).norm(), 1e-7) << w.transpose();
  }
}

TEST(Pose, ComposesAndInverts) {
  const Pose T_a_b{rotation_from_vector({0.1, 0.2, -0.3}), {1, 2, 3}};
  const Pose T_b_c{rotation_from_vector({-0.4, 0.1, 0.6}), {-1, 0.5, 2}};
  const Eigen::Vector3d x_c(0.3, -0.7, 1.1);
  EXPECT_LT((T_a_b * (T_b_c * x_c) - (T_a_b * T_b_c) * x_c).norm(), 1e-14);
  EXPECT_LT((T_a_b.inverse() * (T_a_b * x_c) - x_c).norm(), 1e-14);
}

}  // namespace
}  // namespace vernier
