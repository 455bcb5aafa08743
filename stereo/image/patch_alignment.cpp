// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/image/patch_alignment.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace vernier::stereo::internal {
namespace {

constexpr int max_steps = 25;
constexpr double min_step_px = 0.01;
// Differences rise less than the image does: full steps overshoot.
constexpr double step_share = 0.6;
constexpr double max_gain = 3;
constexpr double max_stretch = 0.6;

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

std::array<double, 4> cubic_weights(double t) {
  const double t2 = t * t, t3 = t2 * t;
  return {0.5 * (-t3 + 2 * t2 - t), 0.5 * (3 * t3 - 5 * t2 + 2), 0.5 * (-3 * t3 + 4 * t2 + t),
          0.5 * (t3 - t2)};
}

/// The left patch: offset, weight, grey level and Jacobian row of each pixel (by shift u, v,
/// stretch, shear, gain, offset).
struct Template {
  std::vector<Eigen::Vector2d> offsets;
  Eigen::VectorXd weight, grey;
  Eigen::Matrix<double, Eigen::Dynamic, 6> J;
  Matrix6d inverse;  ///< of Jᵀ W J
  bool holds = false;
};

/// Σ wx wy K over the 4 x 4 pixels from (left − 1, top − 1); the border is replicated.
double weighed(const cv::Mat& image,
               int left,
               int top,
               const std::array<double, 4>& wx,
               const std::array<double, 4>& wy) {
  const bool inside = left >= 1 && top >= 1 && left + 2 < image.cols && top + 2 < image.rows;
  double sum = 0;
  for (int j = 0; j < 4; ++j) {
    double line = 0;
    if (inside) {
      const float* at = image.ptr<float>(top + j - 1) + left - 1;
      for (int i = 0; i < 4; ++i) line += wx[i] * at[i];
    } else {
      const float* row = image.ptr<float>(std::clamp(top + j - 1, 0, image.rows - 1));
      for (int i = 0; i < 4; ++i) line += wx[i] * row[std::clamp(left + i - 1, 0, image.cols - 1)];
    }
    sum += wy[j] * line;
  }
  return sum;
}

/// Grey levels at p + (i, j), |i| and |j| <= reach, one image row per column.
Eigen::MatrixXd grid_about(const cv::Mat& image, const Eigen::Vector2d& p, int reach) {
  const int left = static_cast<int>(std::floor(p.x())), top = static_cast<int>(std::floor(p.y()));
  const auto wx = cubic_weights(p.x() - left), wy = cubic_weights(p.y() - top);
  const bool whole = p.x() == left && p.y() == top && left - reach >= 0 && top - reach >= 0 &&
                     left + reach < image.cols && top + reach < image.rows;
  Eigen::MatrixXd grid(2 * reach + 1, 2 * reach + 1);
  for (int j = -reach; j <= reach; ++j) {
    for (int i = -reach; i <= reach; ++i) {
      grid(i + reach, j + reach) =
          whole ? image.at<float>(top + j, left + i) : weighed(image, left + i, top + j, wx, wy);
    }
  }
  return grid;
}

Template make_template(const cv::Mat& left,
                       const Eigen::Vector2d& p,
                       const Eigen::Vector2d& direction,
                       int half) {
  Template patch;
  const int n = (2 * half + 1) * (2 * half + 1);
  patch.weight.resize(n);
  patch.grey.resize(n);
  patch.J.resize(n, 6);
  const Eigen::MatrixXd grid = grid_about(left, p, half + 1);
  int row = 0;
  for (int j = -half; j <= half; ++j) {
    for (int i = -half; i <= half; ++i, ++row) {
      const int x = i + half + 1, y = j + half + 1;
      const Eigen::Vector2d g(0.5 * (grid(x + 1, y) - grid(x - 1, y)),
                              0.5 * (grid(x, y + 1) - grid(x, y - 1)));
      const double along = g.dot(direction);
      patch.offsets.emplace_back(i, j);
      patch.weight[row] = std::exp(-2.0 * (i * i + j * j) / (half * half));
      patch.grey[row] = grid(x, y);
      patch.J.row(row) << g.x(), g.y(), along * i, along * j, patch.grey[row], 1;
    }
  }
  const Matrix6d N = patch.J.transpose() * patch.weight.asDiagonal() * patch.J;
  const Vector6d scale = N.diagonal().cwiseMax(1e-12).cwiseSqrt();
  const Matrix6d scaled = scale.cwiseInverse().asDiagonal() * N * scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scaled);
  patch.holds = eigen.eigenvalues()[0] > 1e-8;
  patch.inverse = N.inverse();
  return patch;
}

/// Maps offsets from the left pixel to right pixels.
struct Warp {
  Eigen::Matrix2d D = Eigen::Matrix2d::Identity();
  Eigen::Vector2d q;
};

Eigen::VectorXd sampled(const cv::Mat& right, const Template& patch, const Warp& warp) {
  Eigen::VectorXd values(patch.grey.size());
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const Eigen::Vector2d at = warp.q + warp.D * patch.offsets[i];
    values[i] = grey_between(right, at.x(), at.y());
  }
  return values;
}

double correlation(const Eigen::VectorXd& w, Eigen::VectorXd a, Eigen::VectorXd b) {
  a.array() -= w.dot(a) / w.sum();
  b.array() -= w.dot(b) / w.sum();
  const double power = w.dot(a.cwiseAbs2()) * w.dot(b.cwiseAbs2());
  return power > 0 ? w.dot(a.cwiseProduct(b)) / std::sqrt(power) : 0;
}

/// Composes the warp with the inverse of the small update of `fit`.
Warp composed(const Warp& warp, const Vector6d& fit, const Eigen::Vector2d& direction) {
  const double gain = fit[4] / step_share;
  const Eigen::Matrix2d small =
      Eigen::Matrix2d::Identity() + direction * fit.segment<2>(2).transpose() / gain;
  Warp next;
  next.D = warp.D * small.inverse();
  next.q = warp.q - next.D * fit.head<2>() / gain;
  return next;
}

Eigen::Matrix2d covariance(const Template& patch,
                           const Warp& warp,
                           const Eigen::VectorXd& values,
                           const Vector6d& fit,
                           const AlignmentOptions& options) {
  const Eigen::VectorXd residual = values - patch.J * fit;
  const double gain2 = fit[4] * fit[4], noise_l = options.noise_left, noise_r = options.noise_right;
  const double mean_square = std::max(patch.weight.dot(residual.cwiseAbs2()) / patch.weight.sum(),
                                      gain2 * noise_l * noise_l + noise_r * noise_r) /
                             gain2;
  const Matrix6d spread = patch.J.transpose() * patch.weight.cwiseAbs2().asDiagonal() * patch.J;
  const Matrix6d C = patch.inverse * spread * patch.inverse;
  return mean_square * warp.D * C.topLeftCorner<2, 2>() * warp.D.transpose();
}

}  // namespace

double grey_between(const cv::Mat& image, double x, double y) {
  const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
  return weighed(image, left, top, cubic_weights(x - left), cubic_weights(y - top));
}

std::optional<Alignment> align_patch(const cv::Mat& left,
                                     const cv::Mat& right,
                                     const Eigen::Vector2d& left_px,
                                     const Eigen::Vector2d& right_px,
                                     const Eigen::Vector2d& direction,
                                     const AlignmentOptions& options) {
  const Eigen::Matrix2d left_by_right = options.right_by_left.inverse();
  const Eigen::Vector2d in_left = left_by_right * direction;
  const Template patch = make_template(left, left_px, in_left, options.half_px);
  if (!patch.holds) return std::nullopt;
  Warp warp;
  warp.D = options.right_by_left;
  warp.q = right_px;
  for (int step = 0; step < max_steps; ++step) {
    const Eigen::VectorXd values = sampled(right, patch, warp);
    const Vector6d fit = patch.inverse * (patch.J.transpose() * patch.weight.cwiseProduct(values));
    if (!(fit[4] > 1 / max_gain && fit[4] < max_gain)) return std::nullopt;
    const Warp next = composed(warp, fit, in_left);
    const bool settled = (next.q - warp.q).norm() < min_step_px;
    warp = next;
    if (!((warp.q - right_px).norm() <= options.max_shift_px)) return std::nullopt;
    if ((left_by_right * warp.D - Eigen::Matrix2d::Identity()).cwiseAbs().maxCoeff() >
        max_stretch) {
      return std::nullopt;
    }
    if (settled) {
      return Alignment{warp.q, covariance(patch, warp, values, fit, options),
                       correlation(patch.weight, patch.grey, values)};
    }
  }
  return std::nullopt;
}

}  // namespace vernier::stereo::internal
