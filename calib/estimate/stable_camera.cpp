// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/stable_camera.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "calib/base/decompositions.h"
#include "calib/camera.h"
#include "calib/pose.h"

namespace vernier::internal {
namespace {

constexpr int columns = 6, rows = 5;
constexpr double covered = 0.8;  ///< of width and height: a lens is seldom known at its borders
constexpr std::size_t fewest_pixels = 16;
/// A standard deviation that moves no pixel by this much does not show.
constexpr double visible_px = 3e-3;
constexpr int most_solver_steps = 50;
constexpr double converged = 1e-4;  // a step's norm in the residuals: 1e-6 px
constexpr double smallest_damping = 1e-6;

bool has_image(const Camera& camera) {
  return camera.f_px() > 0 && camera.ax() > 0 && camera.parameters.allFinite();
}

}  // namespace

struct StableCamera::Residual {
  Eigen::VectorXd r;
  Eigen::MatrixXd J;  ///< by the free intrinsics in σ, then the turn in turn units
};

/// A camera turned so that no turn is left in its image.
struct StableCamera::Balance {
  TurnedCamera turned;
  Residual residual;
  Eigen::Matrix3d by_turn;  ///< the inverse of the derivative of that turn by the frame's
};

StableCamera::StableCamera(const Camera& mean, const Eigen::MatrixXd& covariance) : mean_(mean) {
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    if (covariance(i, i) > 0) free_.push_back(i);
  }
  sigma_ = covariance.diagonal()(free_).cwiseSqrt();
  turn_unit_rad_ = visible_px / std::abs(mean.f_px());
  if (free_.empty() || !has_image(mean)) return;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const Eigen::Vector2d part((i + 0.5) / columns - 0.5, (j + 0.5) / rows - 0.5);
      const Eigen::Vector2d size = (mean.size_px - Eigen::Vector2i::Ones()).cast<double>();
      const Eigen::Vector2d q = (0.5 + covered * part.array()) * size.array();
      const auto ray = try_unproject(mean, q);
      if (!ray) continue;
      rays_.push_back(*ray);
      pixels_px_.push_back(q);
    }
  }
  if (rays_.size() < fewest_pixels) return;
  weights_.assign(rays_.size(), 1);
  const auto n = static_cast<Eigen::Index>(free_.size());
  if (!linearise()) {
    inverse_.resize(0, 0);
    return;
  }
  // Pixels that are badly known in spite of the turn, such as those that no board reached, count
  // for as little as is known of them.
  const Eigen::MatrixXd by_intrinsics =
      (slope_.leftCols(n) + slope_.rightCols<3>() * turns_) * sigma_.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd known = by_intrinsics * covariance(free_, free_);
  for (std::size_t k = 0; k < rays_.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(2 * k);
    const double variance =
        known.middleRows<2>(row).cwiseProduct(by_intrinsics.middleRows<2>(row)).sum();
    const double unit = 2 * static_cast<double>(rays_.size());  // as residual() has it
    weights_[k] = 1 / std::sqrt(1 + std::max(0.0, unit * variance / 2));
  }
  const double best = *std::max_element(weights_.begin(), weights_.end());
  for (double& weight : weights_) weight /= best;
  if (!linearise()) inverse_.resize(0, 0);
}

bool StableCamera::linearise() {
  const auto n = static_cast<Eigen::Index>(free_.size());
  const auto start = residual({mean_, Eigen::Matrix3d::Identity()});
  if (!start) return false;
  slope_ = start->J;
  const Eigen::MatrixXd R = qr_triangle(slope_);
  if (!(R.diagonal().cwiseAbs().minCoeff() > 0)) return false;
  inverse_ = R.triangularView<Eigen::Upper>().solve(orthonormal_basis(slope_).transpose());
  const Eigen::MatrixXd turn = slope_.rightCols<3>();
  turns_ = -(turn.transpose() * turn).ldlt().solve(turn.transpose() * slope_.leftCols(n));
  turn_left_ = inverse_.bottomRows<3>() - turns_ * inverse_.topRows(n);
  return inverse_.allFinite() && turns_.allFinite();
}

std::optional<StableCamera::Residual> StableCamera::residual(const TurnedCamera& at) const {
  if (!has_image(at.camera)) return std::nullopt;
  const auto n = static_cast<Eigen::Index>(free_.size());
  const auto points = static_cast<Eigen::Index>(rays_.size());
  Residual result{Eigen::VectorXd(2 * points + n), Eigen::MatrixXd::Zero(2 * points + n, n + 3)};
  const double unit = 1 / (visible_px * std::sqrt(2.0 * static_cast<double>(points)));
  ProjectionJacobian by;
  for (Eigen::Index k = 0; k < points; ++k) {
    const auto at_k = static_cast<std::size_t>(k);
    const double weight = weights_[at_k] * unit;
    const Eigen::Vector3d x = at.turn * rays_[at_k];
    if (!(x.z() > 0)) return std::nullopt;
    result.r.segment<2>(2 * k) = weight * (project(at.camera, x, by) - pixels_px_[at_k]);
    result.J.block(2 * k, 0, 2, n) = weight * by.camera(Eigen::all, free_) * sigma_.asDiagonal();
    result.J.block<2, 3>(2 * k, n) = -weight * turn_unit_rad_ * by.point * hat(x);
  }
  result.r.tail(n) = free(at.camera.parameters - mean_.parameters);
  result.J.bottomLeftCorner(n, n).setIdentity();
  if (!result.r.allFinite() || !result.J.allFinite()) return std::nullopt;
  return result;
}

Eigen::VectorXd StableCamera::free(const Eigen::VectorXd& intrinsics) const {
  return intrinsics(free_).cwiseQuotient(sigma_);
}

TurnedCamera StableCamera::moved(const TurnedCamera& from, const Eigen::VectorXd& step) const {
  TurnedCamera to = from;
  const auto n = static_cast<Eigen::Index>(free_.size());
  to.camera.parameters(free_) += sigma_.cwiseProduct(step.head(n));
  to.turn = rotation_from_vector(turn_unit_rad_ * step.tail<3>()) * from.turn;
  return to;
}

Eigen::Vector3d StableCamera::linear_turn(const Eigen::VectorXd& intrinsics) const {
  if (inverse_.size() == 0) return Eigen::Vector3d::Zero();
  return turn_unit_rad_ * (turns_ * free(intrinsics));
}

Eigen::Matrix3Xd StableCamera::linear_turn_by_intrinsics() const {
  Eigen::Matrix3Xd by = Eigen::Matrix3Xd::Zero(3, mean_.parameters.size());
  if (inverse_.size() == 0) return by;
  by(Eigen::all, free_) = turn_unit_rad_ * turns_ * sigma_.cwiseInverse().asDiagonal();
  return by;
}

std::optional<TurnedCamera> StableCamera::camera(const Eigen::VectorXd& stable) const {
  if (inverse_.size() == 0) {
    TurnedCamera plain{mean_, Eigen::Matrix3d::Identity()};
    plain.camera.parameters += stable;
    return plain;
  }
  Eigen::VectorXd linear(sigma_.size() + 3);
  linear << free(stable), turns_ * free(stable);
  const Eigen::VectorXd goal = slope_ * linear;
  TurnedCamera now = moved({mean_, Eigen::Matrix3d::Identity()}, linear);
  auto found = residual(now);
  if (!found) return std::nullopt;
  // Levenberg and Marquardt from the linear model. A minimum other than zero is one all the same:
  // it is what a calibration would find.
  double damping = 0;
  for (int iteration = 0; iteration < most_solver_steps; ++iteration) {
    const Eigen::VectorXd missing = goal - found->r;
    Eigen::MatrixXd N = found->J.transpose() * found->J;
    const Eigen::VectorXd g = found->J.transpose() * missing;
    N.diagonal() *= 1 + damping;
    const Eigen::VectorXd step = solve_symmetric(N, g);
    if (!step.allFinite()) break;
    const double seen = (found->J * step).norm();
    if (seen <= converged) break;
    const TurnedCamera tried = moved(now, step);
    auto there = residual(tried);
    if (there && (goal - there->r).norm() < missing.norm()) {
      now = tried;
      found = std::move(there);
      damping = damping > smallest_damping ? damping / 10 : 0;
    } else {
      damping = std::max(smallest_damping, 10 * damping);
    }
  }
  return now;
}

// By Newton's method: the turn of the frame with which none is left in the image.
std::optional<StableCamera::Balance> StableCamera::balance(const Camera& camera) const {
  const Eigen::VectorXd moved_by = free(camera.parameters - mean_.parameters);
  TurnedCamera now{camera, rotation_from_vector(turn_unit_rad_ * (turns_ * moved_by))};
  for (int iteration = 0; iteration < most_solver_steps; ++iteration) {
    auto found = residual(now);
    if (!found) return std::nullopt;
    const Eigen::Vector3d left = turn_left_ * found->r;
    const Eigen::Matrix3d by_turn = (turn_left_ * found->J.rightCols<3>()).inverse();
    if (left.norm() <= converged * (1 + (inverse_ * found->r).norm())) {
      return Balance{now, *std::move(found), by_turn};
    }
    const Eigen::Vector3d step = by_turn * -left;
    if (!step.allFinite()) return std::nullopt;
    now.turn = rotation_from_vector(turn_unit_rad_ * step) * now.turn;
  }
  return std::nullopt;
}

StableCamera::Coordinates StableCamera::coordinates(const Balance& at) const {
  const auto n = static_cast<Eigen::Index>(free_.size());
  const auto all = at.turned.camera.parameters.size();
  Coordinates result{at.turned.camera.parameters - mean_.parameters, at.turned.turn,
                     Eigen::MatrixXd::Identity(all, all), Eigen::Matrix3Xd::Zero(3, all)};
  const Eigen::MatrixXd to_y = inverse_.topRows(n);
  result.stable(free_) = sigma_.cwiseProduct(to_y * at.residual.r);
  // The turn follows the intrinsics so that none is left.
  const Eigen::MatrixXd& J = at.residual.J;
  const Eigen::MatrixXd turned = -at.by_turn * (turn_left_ * J.leftCols(n));
  const Eigen::MatrixXd moved_y = to_y * (J.leftCols(n) + J.rightCols<3>() * turned);
  const Eigen::VectorXd per_sigma = sigma_.cwiseInverse();
  result.by_intrinsics(free_, free_) = sigma_.asDiagonal() * moved_y * per_sigma.asDiagonal();
  result.turn_by_intrinsics(Eigen::all, free_) = turn_unit_rad_ * turned * per_sigma.asDiagonal();
  return result;
}

std::optional<StableCamera::Coordinates> StableCamera::coordinates(const Camera& camera) const {
  if (inverse_.size() == 0) {
    const auto all = camera.parameters.size();
    return Coordinates{camera.parameters - mean_.parameters, Eigen::Matrix3d::Identity(),
                       Eigen::MatrixXd::Identity(all, all), Eigen::Matrix3Xd::Zero(3, all)};
  }
  const auto at = balance(camera);
  if (!at) return std::nullopt;
  Coordinates result = coordinates(*at);
  if (!result.by_intrinsics.allFinite() || !result.turn_by_intrinsics.allFinite()) {
    return std::nullopt;
  }
  return result;
}

}  // namespace vernier::internal
