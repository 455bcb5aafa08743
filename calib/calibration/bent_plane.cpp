// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/bent_plane.h"

#include <Eigen/Dense>
#include <opencv2/calib3d.hpp>

namespace vernier::internal {
namespace {

using Parameters = Eigen::Matrix<double, 10, 1>;  // of H row by row without its last, c_l, c_r

Eigen::Vector2d bent(const Eigen::Vector2d& x, double c) { return x * (1 + c * x.squaredNorm()); }

Eigen::Vector2d misfit(const Parameters& a, const PointPair& p) {
  const Eigen::Vector2d l = bent(p.left, a[8]);
  const double w = a[6] * l.x() + a[7] * l.y() + 1;
  return Eigen::Vector2d((a[0] * l.x() + a[1] * l.y() + a[2]) / w,
                         (a[3] * l.x() + a[4] * l.y() + a[5]) / w) -
         bent(p.right, a[9]);
}

/// Gauss–Newton steps over the points with a misfit below `near`.
Parameters refined(Parameters a, const std::vector<PointPair>& points, double near) {
  for (int round = 0; round < 10; ++round) {
    Eigen::Matrix<double, 10, 10> N = 1e-9 * Eigen::Matrix<double, 10, 10>::Identity();
    Parameters g = Parameters::Zero();
    for (const PointPair& p : points) {
      const Eigen::Vector2d r = misfit(a, p);
      if (!(r.norm() < near)) continue;
      Eigen::Matrix<double, 2, 10> J;
      for (int i = 0; i < 10; ++i) {
        Parameters step = Parameters::Zero();
        step[i] = 1e-6;
        J.col(i) = (misfit(a + step, p) - misfit(a - step, p)) / 2e-6;
      }
      N += J.transpose() * J;
      g += J.transpose() * r;
    }
    const Parameters step = N.ldlt().solve(g);
    a -= step;
    if (step.norm() < 1e-10) break;
  }
  return a;
}

}  // namespace

double fraction_on_distorted_plane(const std::vector<PointPair>& points, double limit) {
  std::vector<cv::Point2d> left, right;
  for (const PointPair& p : points) {
    left.emplace_back(p.left.x(), p.left.y());
    right.emplace_back(p.right.x(), p.right.y());
  }
  // The bending of a plane by an approximate lens model; a scene with depth already exceeds it.
  const double near = limit + 0.02;
  const auto parameters = [](const cv::Mat& H) {
    Parameters a = Parameters::Zero();
    for (int i = 0; i < 8; ++i) a[i] = H.at<double>(i / 3, i % 3) / H.at<double>(2, 2);
    return a;
  };
  const auto share = [&](const Parameters& a, double within) {
    int inside = 0;
    for (const PointPair& p : points) inside += misfit(a, p).norm() < within;
    return inside / static_cast<double>(points.size());
  };
  const cv::Mat rough = cv::findHomography(left, right, 0);
  if (rough.empty() || share(parameters(rough), 3 * near) < 0.5) return 0;
  const cv::Mat H = cv::findHomography(left, right, cv::RANSAC, near);
  if (H.empty() || share(parameters(H), near) < 0.8) return 0;
  Parameters a = refined(parameters(H), points, near);
  a = refined(a, points, 2 * limit);
  return share(a, limit);
}

}  // namespace vernier::internal
