// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/odometry/path_covariance.h"

#include <cstddef>
#include <map>
#include <span>
#include <utility>

#include "calib/pose.h"
#include "localise/odometry.h"
#include "localise/odometry/step_refinement.h"

namespace vernier::localise::internal {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

ProductDerivatives::ProductDerivatives(const Pose& A, const Pose& B) {
  by_first.bottomLeftCorner<3, 3>() = -hat(A.R * B.t);
  by_second.topLeftCorner<3, 3>() = A.R;
  by_second.bottomRightCorner<3, 3>() = A.R;
}

Matrix6d PathCovariance::FollowedCorner::squared() const {
  return noise * noise.transpose() + residual * residual.transpose();
}

void PathCovariance::add(const ProductDerivatives& d,
                         std::span<const CornerLink> inliers,
                         std::span<const CornerInfluence> influences) {
  closed_ = d.by_first * closed_ * d.by_first.transpose();
  for (auto& [index, corner] : followed_) {
    corner.noise = d.by_first * corner.noise;
    corner.residual = d.by_first * corner.residual;
  }
  std::map<int, FollowedCorner> now;
  for (std::size_t i = 0; i < inliers.size(); ++i) {
    const CornerInfluence& of = influences[i];
    FollowedCorner before{d.by_second * of.from, d.by_second * of.residual};
    if (const auto found = followed_.find(inliers[i].from); found != followed_.end()) {
      before.noise += found->second.noise;
      before.residual += found->second.residual;
      followed_.erase(found);
    }
    closed_ += before.noise * before.noise.transpose();
    now[inliers[i].to] = {d.by_second * of.to, before.residual};
  }
  for (const auto& [index, corner] : followed_) closed_ += corner.squared();
  followed_ = std::move(now);
}

Matrix6d PathCovariance::covariance() const {
  Matrix6d sum = closed_;
  for (const auto& [index, corner] : followed_) sum += corner.squared();
  return 0.5 * (sum + sum.transpose());
}

}  // namespace vernier::localise::internal
