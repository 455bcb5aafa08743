// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/interval.h"
#include "calib/rig.h"
#include "calib/rig_and_boards.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "calib/triangulation.h"

namespace vernier {

/// Which frame a triangulated point's error is told in.
enum class TriangulationFrame {
  rig,         ///< the first camera's: what a robot that knows its camera's place sees
  stabilised,  ///< that of the boards' mean, in which the room stands still (mrcal's default)
};

/// A point and the covariances (m²) of its two independent errors.
struct TriangulatedPoint {
  Eigen::Vector3d x_m;          ///< first camera's frame
  Eigen::Matrix3d calibration;  ///< of the rig's errors, the same at every look
  Eigen::Matrix3d observation;  ///< of the pair's own pixel noise, new at every look
};

/// Linear propagation through Mid2 (calib/triangulation.h), x = x(q, a):
///
///     observation = σ² J_q J_qᵀ,   calibration = J_a C J_aᵀ
///
/// in the rig's frame. Stabilised, δx loses what the boards' mean motion (w, u) explains,
///
///     δx = J_a δa − (w × x + u)
///
/// because a rig whose frame turns with its errors sees the room turn too: this is mrcal's
/// stabilize_coords=True, through the six numbers of calib/uncertainty/pose_covariance.h.
class TriangulationUncertainty {
 public:
  TriangulationUncertainty(const RigAndBoards& joint, TriangulationFrame frame, int other = 1);
  /// In the rig's frame. Throws Error where the covariance is of other parameters.
  TriangulationUncertainty(const Rig& rig, const Eigen::MatrixXd& rig_covariance, int other = 1);

  /// With pixel noise σ = pair_sigma_px on each coordinate of the pair. Nothing where the pair has
  /// no point.
  std::optional<TriangulatedPoint> at(const PixelPair& pair, double pair_sigma_px) const;

  /// Covariance (m²) between the calibration errors of two points: they move together, so a length
  /// between them is better known than they are. Nothing where either has no point.
  std::optional<Eigen::Matrix3d> between(const PixelPair& a, const PixelPair& b) const;

 private:
  using Sensitivity = Eigen::Matrix<double, 3, Eigen::Dynamic>;
  Sensitivity sensitivity(const PointTriangulation& point) const;

  Rig rig_;
  int other_;
  bool stabilised_ = false;
  Eigen::MatrixXd covariance_;  ///< of the rig, then (stabilised) of the boards' motion
};

/// How well a pair knows the depth of a point on the left optical axis, as far as its calibration
/// decides (no matching error).
struct DepthUncertainty {
  double range_m = 0;
  double sigma_linear_m = 0;      ///< J C Jᵀ
  double sigma_sampled_m = 0;     ///< over the draws with a positive depth
  double non_physical_share = 0;  ///< draws in which the rays do not meet in front of the rig
  /// 2.5 and 97.5 % over all draws; those in which the rays part count as beyond every depth, so an
  /// end can be infinite.
  Interval interval_95_m{0, 0};
};

/// Linear and sampled, side by side: the pixels are those of the estimate, the rig that reads them
/// is drawn. Depth is not linear in the parameters, so trust the sampled one where they part.
/// Throws Error unless ranges are above 0 and finite, and samples at least 2.
std::vector<DepthUncertainty> depth_uncertainty(const RigEstimate& estimate,
                                                const std::vector<double>& ranges_m,
                                                const SamplingOptions& options = {});

}  // namespace vernier
