// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/observability.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>
#include <variant>

#include "calib/base/decompositions.h"
#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/data_and_prior.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal {

namespace {

/// A change of the rig's parameters and the resulting change of the essential matrix.
struct Move {
  Eigen::VectorXd parameters;
  Eigen::Matrix3d essential;
};

/// Power of the coordinates' scale in each of k1 k2 p1 p2 k3 k4 k5 k6.
constexpr int scale_powers[] = {2, 4, 1, 1, 6, 2, 4, 6};
static_assert(std::size(scale_powers) >= max_distortion_count);

/// The parameter changes that multiply the rays of a camera by a matrix, and that matrix.
std::vector<std::pair<Eigen::VectorXd, Eigen::Matrix3d>> ray_moves(const Camera& camera) {
  check_parameters(camera);
  const Eigen::VectorXd& a = camera.parameters;
  const auto k = a.tail(a.size() - core_parameter_count);
  const auto none = [&] { return Eigen::VectorXd(Eigen::VectorXd::Zero(a.size())); };
  std::vector<std::pair<Eigen::VectorXd, Eigen::Matrix3d>> moves;
  const Eigen::Matrix3d shrink = Eigen::Vector3d(-1, -1, 0).asDiagonal();
  Eigen::VectorXd scale = none();
  scale[0] = a[0];
  if (!k.isZero(0)) {
    if (std::holds_alternative<Fisheye4>(camera.model)) return moves;
    for (Eigen::Index i = 0; i < k.size(); ++i) {
      scale[core_parameter_count + i] = scale_powers[i] * k[i];
    }
    moves.emplace_back(scale, shrink);
    return moves;
  }
  if (std::holds_alternative<Fisheye4>(camera.model)) return moves;  // equidistant is a distortion
  moves.emplace_back(scale, shrink);
  Eigen::VectorXd ax = none(), ox = none(), oy = none();
  ax[1] = camera.ax();
  ox[2] = camera.f_px() * camera.ax();
  oy[3] = camera.f_px();
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  M(0, 0) = -1;
  moves.emplace_back(ax, M);
  M.setZero();
  M(0, 2) = -1;
  moves.emplace_back(ox, M);
  M.setZero();
  M(1, 2) = -1;
  moves.emplace_back(oy, M);
  return moves;
}

std::vector<Move> essential_moves(const Rig& rig) {
  const int p = parameter_count(rig), pose = pose_index(rig, 1);
  const Pose& T = rig.T_camera_first[1];
  const Eigen::Matrix3d E = hat(T.t) * T.R;
  std::vector<Move> moves;
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector3d unit = Eigen::Vector3d::Unit(i % 3);
    Move move{Eigen::VectorXd::Unit(p, pose + i), {}};
    move.essential =
        i < 3 ? Eigen::Matrix3d(hat(T.t) * hat(unit) * T.R) : Eigen::Matrix3d(hat(unit) * T.R);
    moves.push_back(move);
  }
  for (int c = 0; c < 2; ++c) {
    for (const auto& [change, M] : ray_moves(rig.cameras[static_cast<std::size_t>(c)])) {
      Move move{Eigen::VectorXd::Zero(p), {}};
      move.parameters.segment(intrinsics_index(rig, c), change.size()) = change;
      move.essential = c == 0 ? Eigen::Matrix3d(E * M) : Eigen::Matrix3d(M.transpose() * E);
      moves.push_back(move);
    }
  }
  return moves;
}

Eigen::Map<const Eigen::Matrix<double, 9, 1>> as_vector(const Eigen::Matrix3d& M) {
  return Eigen::Map<const Eigen::Matrix<double, 9, 1>>(M.data());
}

}  // namespace

Eigen::MatrixXd unobservable_directions(const Rig& rig,
                                        const std::optional<Eigen::Vector3d>& plane) {
  const Pose& T = rig.T_camera_first[1];
  // Essential matrices that give the same residuals.
  Eigen::Matrix<double, 9, Eigen::Dynamic> same(9, plane ? 3 : 1);
  if (plane) {
    const Eigen::Matrix3d H = T.R + T.t * plane->transpose();
    const Eigen::Matrix3d G = H.inverse().transpose();
    for (int i = 0; i < 3; ++i) {
      const Eigen::Matrix3d E = G * hat(Eigen::Vector3d::Unit(i));
      same.col(i) = as_vector(E);
    }
  } else {
    const Eigen::Matrix3d E = hat(T.t) * T.R;
    same.col(0) = as_vector(E);
  }
  const Eigen::MatrixXd Q = orthonormal_basis(same);
  const std::vector<Move> moves = essential_moves(rig);
  const auto n = static_cast<Eigen::Index>(moves.size());
  Eigen::MatrixXd D(9, n), parameters(parameter_count(rig), n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Move& move = moves[static_cast<std::size_t>(i)];
    const double scale = move.essential.norm();
    D.col(i) = as_vector(move.essential) / scale;
    parameters.col(i) = move.parameters / scale;
  }
  D -= Q * (Q.transpose() * D).eval();
  const RightSingularVectors svd(D);
  Eigen::Index rank = 0;
  for (; rank < svd.singular_values.size(); ++rank) {
    if (!(svd.singular_values[rank] > 1e-9 * svd.singular_values[0])) break;
  }
  return parameters * svd.V.rightCols(n - rank);
}

Observability observability(const Rig& rig,
                            const std::vector<std::string>& names,
                            const Eigen::MatrixXd& before,
                            const Eigen::MatrixXd& after) {
  const Eigen::VectorXd sd = before.diagonal().cwiseSqrt();
  const Eigen::VectorXd inverse_sd = sd.cwiseInverse();
  const Eigen::MatrixXd R0 = inverse_sd.asDiagonal() * before * inverse_sd.asDiagonal();
  const Eigen::MatrixXd R1 = inverse_sd.asDiagonal() * after * inverse_sd.asDiagonal();
  const SymmetricEigen prior(0.5 * (R0 + R0.transpose()));
  if (!(prior.eigenvalues()[0] > 1e-13 * prior.eigenvalues()[R0.rows() - 1])) {
    throw Error("prior",
                "its covariance is singular along " +
                    describe_direction(prior.eigenvectors().col(0), names),
                "fix parameters that are known exactly");
  }
  const Eigen::MatrixXd root = prior.root(), inverse_root = prior.inverse_root();
  const Eigen::MatrixXd ratio = inverse_root * R1 * inverse_root;
  const SymmetricEigen eigen(0.5 * (ratio + ratio.transpose()));
  Observability o;
  for (Eigen::Index i = 0; i < ratio.rows(); ++i) {
    ObservedDirection direction;
    direction.sd_ratio = std::sqrt(std::max(0.0, eigen.eigenvalues()[i]));
    direction.direction = (root * eigen.eigenvectors().col(i)).normalized();
    direction.description = describe_direction(direction.direction, names);
    o.improved += direction.sd_ratio <= 0.5;
    o.unchanged += direction.sd_ratio > 0.9;
    o.from_data += 1 - eigen.eigenvalues()[i];
    o.directions.push_back(std::move(direction));
  }
  // Along the scale, as far as the position is free.
  const Eigen::Vector3d T = rig.T_camera_first[1].t;
  const std::vector<std::string> all = parameter_names(rig);
  Eigen::VectorXd n = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(names.size()));
  for (int i = 0; i < 3; ++i) {
    const auto found = std::find(names.begin(), names.end(),
                                 all[static_cast<std::size_t>(pose_index(rig, 1) + 3 + i)]);
    if (found != names.end()) n[found - names.begin()] = T[i];
  }
  o.baseline_sd_before_m = std::sqrt(n.dot(before * n)) / T.norm();
  o.baseline_sd_after_m = std::sqrt(n.dot(after * n)) / T.norm();
  const auto information = [&](const Eigen::MatrixXd& scaled) {
    const Eigen::VectorXd m = inverse_sd.cwiseProduct(n);
    return m.dot(solve_symmetric(scaled, m));
  };
  if (!n.isZero(0)) o.scale_information_ratio = information(R1) / information(R0);
  return o;
}

}  // namespace vernier::internal
