// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/estimate/stable_camera.h"
#include "calib/rig.h"

namespace vernier::internal {

/// A rig moved away from another, and how far its frame, the first camera's, turned with it.
struct MovedRig {
  Rig rig;
  Eigen::Matrix3d turn;         ///< of the first camera's frame
  Eigen::Vector3d linear_turn;  ///< its rotation vector in the linear model
};

/// Where a rig is, and how that changes with its tangent (calib/rig.h).
struct StablePosition {
  Eigen::VectorXd delta;
  Eigen::MatrixXd by_rig;
};

/// difference(rig, mean) and its derivative.
StablePosition tangent_position(const Rig& rig, const Rig& mean);

/// Coordinates of a rig about a mean that agree with the tangent of calib/rig.h to first order, in
/// which calibration errors are closer to normal. The tangent of a narrow lens is curved: centre
/// and direction of each camera are badly known, their sum in the image well, and the sum is a
/// product with the focal length. Errors that are normal in the tangent leave that valley; here
/// each camera has its stable parameters, and its pose is that of the frame turned with the image,
///
///     R_c = V_c exp([ρ_c]ₓ) R̄_c V_0ᵀ,   ρ_c = w_c − v_c + R̄_c v_0
///     t_c = V_c (t̄_c + τ_c − v_c × t̄_c)
///
/// for (w_c, τ_c) the pose's part of the tangent, V_c the turn of camera c and v_c its linear part.
/// If a parameter of a pose, or a direction, has no variance they are the tangent: a camera that
/// may not turn cannot follow its principal point.
class StableCoordinates {
 public:
  /// `covariance`: of the rig's parameters. Those without a variance do not move.
  StableCoordinates(const Rig& mean, const Eigen::MatrixXd& covariance);

  /// The rig at `delta`. std::nullopt if there is none, as far from the mean of a badly known rig.
  std::optional<MovedRig> try_rig(const Eigen::VectorXd& delta) const;
  /// The same; where there is none, retract(mean, delta).
  MovedRig rig(const Eigen::VectorXd& delta) const;

  /// The coordinates of a rig with the same models; std::nullopt if it has none.
  std::optional<StablePosition> try_position(const Rig& rig) const;
  std::optional<Eigen::VectorXd> try_coordinates(const Rig& rig) const;
  /// The same; where there are none, difference(rig, mean).
  Eigen::VectorXd coordinates(const Rig& rig) const;

 private:
  Rig mean_;
  std::vector<StableCamera> cameras_;
  bool is_tangent_ = false;
};

}  // namespace vernier::internal
