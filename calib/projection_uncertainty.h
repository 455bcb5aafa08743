// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_and_boards.h"

namespace vernier {

/// The frame in which a point is fixed while the calibration changes, which projection uncertainty
/// depends on.
enum class PointFixedTo {
  boards,        ///< the world, by the mean of the calibration's boards (mrcal's "mean-pcam")
  camera,        ///< the camera's own frame: its intrinsics alone, the same at every distance
  first_camera,  ///< the rig's frame: intrinsics and the camera's pose
};

/// Covariance (px²) of the projection of a fixed point in a camera. To first order
///
///     q = project(R_c x + t_c),   δq = J_i δi + J_p (w_c × R_c x + τ_c + R_c δx)
///
/// with (w_c, τ_c) the left tangent of the camera's pose and δx = w × x + u the mean motion of the
/// boards (rig_and_motion_covariance) if the point is fixed to them, else 0; a point fixed to the
/// camera has the first term only. At infinity translations vanish. With `boards` and the bound
/// this is mrcal 2.2's projection_uncertainty (method "mean-pcam"; mrcal's documentation,
/// "Propagating calibration uncertainty", and D. Kogan's derivation there), computed from six
/// numbers instead of all board poses.
class ProjectionUncertainty {
 public:
  /// From rig and boards. Any `fixed_to`. Throws Error if the rig's covariance does not match its
  /// parameters, is not symmetric or has a negative variance.
  ProjectionUncertainty(const RigAndBoards& joint, int camera, PointFixedTo fixed_to);
  /// From a covariance of the rig's parameters alone: `camera` or `first_camera`, else Error.
  ProjectionUncertainty(const Rig& rig,
                        const Eigen::MatrixXd& rig_covariance,
                        int camera,
                        PointFixedTo fixed_to);

  /// For the point seen at `pixel` at a range along its ray, m, or infinity. std::nullopt if the
  /// camera's model cannot be inverted. Throws Error unless distance_m > 0.
  std::optional<Eigen::Matrix2d> covariance(const Eigen::Vector2d& pixel, double distance_m) const;

  /// For a point in the camera's frame, m.
  Eigen::Matrix2d covariance_of_point(const Eigen::Vector3d& x_camera) const;
  /// For a point at infinity, by its direction in the camera's frame.
  Eigen::Matrix2d covariance_of_direction(const Eigen::Vector3d& x_camera) const;

  const Camera& camera() const { return camera_; }

 private:
  enum class Range { finite, infinite };
  Eigen::Matrix2d covariance_at(const Eigen::Vector3d& x_camera, Range range) const;
  void keep(const Eigen::MatrixXd& joint, const Rig& rig, int camera, bool with_motion);

  Camera camera_;
  Pose T_camera_first_;
  PointFixedTo fixed_to_;
  bool has_pose_ = false;
  Eigen::MatrixXd covariance_;  ///< of intrinsics, then the camera's pose, then the boards' motion
};

/// Standard deviation in the worst direction: the square root of the larger eigenvalue.
double worst_sd(const Eigen::Matrix2d& covariance);

struct ProjectionGridOptions {
  int columns = 60, rows = 45;
  double distance_m = 1;  ///< along each pixel's ray; or infinity
};

/// Covariances over a camera's image on mrcal's grid: columns x rows pixels from the first to the
/// last pixel.
struct ProjectionGrid {
  int columns = 0, rows = 0;
  std::vector<double> x_px, y_px;           ///< one per column, one per row
  std::vector<Eigen::Matrix2d> covariance;  ///< row by row; NaN if the pixel has no ray
  int absent = 0;                           ///< number of pixels without a ray
};

/// Throws Error unless columns and rows are at least 2 and distance_m > 0.
ProjectionGrid projection_grid(const ProjectionUncertainty& uncertainty,
                               const ProjectionGridOptions& options = {});

}  // namespace vernier
