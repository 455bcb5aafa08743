// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/camera.h"

namespace vernier::internal {

/// A camera and the turn of its frame that leaves its image where it was, as nearly as any turn.
struct TurnedCamera {
  Camera camera;
  Eigen::Matrix3d turn;  ///< of rays: x_turned = turn x
};

/// Stable parameters of one camera (G. J. S. Ross, Nonlinear Estimation, 1990: parameters that are
/// predictions of the model, in which its likelihood is closest to normal). They are what moves in
/// the image: with u_k the mean camera's rays through a grid of pixels q_k, V a turn of its frame,
/// and i the intrinsics,
///
///     r(i, V) = ( (project(i, V u_k) − q_k) / ρ,  (i − i₀) / σ ),    y = A⁺ r,
///
/// A the derivative of r by (i, v) at the mean. y has i's units and is i − i₀ to first order, but a
/// principal point that moves with the camera's direction moves y by what is seen of it. The second
/// part of r, of no weight beside a visible change, keeps what no pixel shows. V is such that to
/// first order no turn is left in the image. A camera with few rays in its image, as of a lens that
/// folds there, has i − i₀ and no turn.
class StableCamera {
 public:
  /// `covariance`: of the intrinsics; those without a variance stay as they are.
  StableCamera(const Camera& mean, const Eigen::MatrixXd& covariance);

  /// The turn, as a rotation vector, that goes with a small change of the intrinsics, and its
  /// derivative.
  Eigen::Vector3d linear_turn(const Eigen::VectorXd& intrinsics) const;
  Eigen::Matrix3Xd linear_turn_by_intrinsics() const;

  /// The camera with these parameters and its turn: the minimum of |r − A y|, or what is nearest to
  /// it after 50 steps. std::nullopt where that begins without an image.
  std::optional<TurnedCamera> camera(const Eigen::VectorXd& stable) const;

  /// The parameters of a camera of the same model and with the same values of those without a
  /// variance, its turn, and their derivatives by the intrinsics (the turn's on the left).
  struct Coordinates {
    Eigen::VectorXd stable;
    Eigen::Matrix3d turn;
    Eigen::MatrixXd by_intrinsics;
    Eigen::Matrix3Xd turn_by_intrinsics;
  };
  std::optional<Coordinates> coordinates(const Camera& camera) const;

 private:
  struct Residual;
  struct Balance;
  bool linearise();
  std::optional<Residual> residual(const TurnedCamera& at) const;
  std::optional<Balance> balance(const Camera& camera) const;
  Coordinates coordinates(const Balance& at) const;
  Eigen::VectorXd free(const Eigen::VectorXd& intrinsics) const;  ///< in σ
  TurnedCamera moved(const TurnedCamera& from, const Eigen::VectorXd& step) const;

  Camera mean_;
  std::vector<Eigen::Index> free_;  ///< intrinsics with a variance
  Eigen::VectorXd sigma_;           ///< of those
  double turn_unit_rad_ = 0;        ///< that moves the image by about ρ
  std::vector<Eigen::Vector3d> rays_;
  std::vector<Eigen::Vector2d> pixels_px_;
  std::vector<double> weights_;  ///< 1 where a pixel is known to ρ, less where it is known less
  Eigen::MatrixXd slope_;        ///< A
  Eigen::MatrixXd inverse_;      ///< A⁺; empty if the camera has none
  Eigen::MatrixXd turns_;        ///< 3 x free: the turn that goes with each of them
  Eigen::MatrixXd turn_left_;    ///< (−turns, I) A⁺: of r, the turn that is left in the image
};

}  // namespace vernier::internal
