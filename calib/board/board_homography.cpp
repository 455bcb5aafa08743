// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/board_homography.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "calib/base/decompositions.h"
#include "calib/board_observations.h"
#include "calib/error.h"

namespace vernier::internal {
namespace {

/// x -> scale (x - centre): zero mean, mean distance √2.
struct Normaliser {
  Eigen::Vector2d centre{0, 0};
  double scale = 1;

  explicit Normaliser(const std::vector<Eigen::Vector2d>& points) {
    for (const auto& p : points) centre += p / static_cast<double>(points.size());
    double distance = 0;
    for (const auto& p : points) distance += (p - centre).norm();
    if (distance > 0) scale = std::sqrt(2.0) * static_cast<double>(points.size()) / distance;
  }
  Eigen::Matrix3d matrix() const {
    Eigen::Matrix3d T;
    T << scale, 0, -scale * centre.x(), 0, scale, -scale * centre.y(), 0, 0, 1;
    return T;
  }
};

Eigen::Matrix3d centre_at_origin(const Eigen::Matrix3d& H, const Eigen::Vector2i& size_px) {
  Eigen::Matrix3d T = Eigen::Matrix3d::Identity();
  T.topRightCorner<2, 1>() = -0.5 * (size_px.cast<double>() - Eigen::Vector2d::Ones());
  return T * H;
}

/// The w that minimises Σ |a w + b|: the median of -b/a with weights |a|.
double min_absolute_w(std::vector<std::pair<double, double>> equations) {
  std::erase_if(equations, [](const auto& e) { return e.first == 0; });
  std::sort(equations.begin(), equations.end(),
            [](const auto& p, const auto& q) { return -p.second / p.first < -q.second / q.first; });
  double total = 0, sum = 0;
  for (const auto& [a, b] : equations) total += std::abs(a);
  for (const auto& [a, b] : equations) {
    sum += std::abs(a);
    if (sum >= 0.5 * total) return -b / a;
  }
  return 0;
}

}  // namespace

void check_flat(const std::vector<Eigen::Vector3d>& target_m) {
  Eigen::Vector3d low = target_m.front(), high = low;
  for (const Eigen::Vector3d& X : target_m) {
    low = low.cwiseMin(X);
    high = high.cwiseMax(X);
  }
  const Eigen::Vector3d extent = high - low;
  if (!(extent.z() <= 0.1 * extent.head<2>().maxCoeff())) {
    throw Error("target", "its corners are not in the plane z = 0, which initialisation needs",
                "give the corners of a flat board with z = 0");
  }
}

BoardHomography board_homography(const std::vector<Eigen::Vector3d>& target_m,
                                 const BoardView& view) {
  std::vector<Eigen::Vector2d> board;
  for (const int id : view.ids) board.emplace_back(target_m[id].head<2>());
  const Normaliser from(board), to(view.pixels_px);
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < board.size(); ++i) {
    const Eigen::Vector3d x = (from.scale * (board[i] - from.centre)).homogeneous();
    const Eigen::Vector2d q = to.scale * (view.pixels_px[i] - to.centre);
    Eigen::Matrix<double, 2, 9> rows = Eigen::Matrix<double, 2, 9>::Zero();
    rows.block<1, 3>(0, 0) = rows.block<1, 3>(1, 3) = x.transpose();
    rows.block<1, 3>(0, 6) = -q.x() * x.transpose();
    rows.block<1, 3>(1, 6) = -q.y() * x.transpose();
    normal += rows.transpose() * rows;
  }
  const SymmetricEigen9 eigen(normal);
  const Eigen::Matrix<double, 9, 1> h = eigen.eigenvectors.col(0);
  Eigen::Matrix3d H = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(h.data());
  H = to.matrix().inverse() * H * from.matrix();
  const double depth = H.row(2).dot(from.centre.homogeneous());  // λ at the corners' centre

  BoardHomography result;
  result.H = depth == 0 ? H : Eigen::Matrix3d(H / depth);
  double sum = 0;
  for (std::size_t i = 0; i < board.size(); ++i) {
    const Eigen::Vector3d p = result.H * board[i].homogeneous();
    sum += (p.hnormalized() - view.pixels_px[i]).squaredNorm();
  }
  result.rms_px = std::sqrt(sum / (2.0 * static_cast<double>(board.size())));
  // det d(u, v)/d(X, Y) = det H / λ³, and λ = 1 at the centre
  result.is_front_facing = result.H.determinant() > 0;
  return result;
}

std::optional<double> focal_length_px(const std::vector<BoardHomography>& views,
                                      const Eigen::Vector2i& size_px) {
  const double unit = size_px.maxCoeff();  // so that all columns have one magnitude
  std::vector<std::pair<double, double>> equations;
  for (const BoardHomography& view : views) {
    const Eigen::Matrix3d H = centre_at_origin(view.H, size_px);
    const Eigen::Vector3d h(H(0, 0) / unit, H(1, 0) / unit, H(2, 0));
    const Eigen::Vector3d v(H(0, 1) / unit, H(1, 1) / unit, H(2, 1));
    const double scale = 1 / (h.norm() * v.norm());
    equations.emplace_back(scale * h.head<2>().dot(v.head<2>()), scale * h.z() * v.z());
    equations.emplace_back(scale * (h.head<2>().squaredNorm() - v.head<2>().squaredNorm()),
                           scale * (h.z() * h.z() - v.z() * v.z()));
  }
  const double w = min_absolute_w(std::move(equations));
  const double f = w > 0 ? unit / std::sqrt(w) : 0;
  if (!(f > 0.05 * unit && f < 100 * unit)) return std::nullopt;
  return f;
}

}  // namespace vernier::internal
