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

/// The frame in which the error of a triangulated point is expressed.
enum class TriangulationFrame {
  rig,         ///< the first camera's frame
  stabilised,  ///< the mean frame of the boards, fixed to the scene (mrcal's default)
};

/// A point and the covariances (m²) of its two independent errors.
struct TriangulatedPoint {
  Eigen::Vector3d x_m;          ///< first camera's frame
  Eigen::Matrix3d calibration;  ///< due to the rig's errors, common to all observations
  Eigen::Matrix3d observation;  ///< due to the pair's pixel noise, independent per observation
};

/// Linear propagation through Mid2 (calib/triangulation.h), x = x(q, a):
///
///     observation = σ² J_q J_qᵀ,   calibration = J_a C J_aᵀ
///
/// in the rig's frame. Stabilised, the boards' mean motion (w, u) is subtracted from δx,
///
///     δx = J_a δa − (w × x + u)
///
/// because a rig whose frame turns with its errors sees the scene turn too: this is mrcal's
/// stabilize_coords=True, computed from the six numbers of calib/uncertainty/pose_covariance.h.
class TriangulationUncertainty {
 public:
  /// Throws Error unless `other` is a camera of the rig and not its first, and if the rig's
  /// covariance does not match its parameters, is not symmetric or has a negative variance.
  TriangulationUncertainty(const RigAndBoards& joint, TriangulationFrame frame, int other = 1);
  /// In the rig's frame. Throws Error as above.
  TriangulationUncertainty(const Rig& rig, const Eigen::MatrixXd& rig_covariance, int other = 1);

  /// With pixel noise σ = pair_sigma_px on each coordinate of the pair. std::nullopt if the pair
  /// cannot be triangulated.
  std::optional<TriangulatedPoint> at(const PixelPair& pair, double pair_sigma_px) const;

  /// Cross-covariance (m²) of the calibration errors of two points: these are correlated, so a
  /// length between the points is better known than the points. std::nullopt if either cannot be
  /// triangulated.
  std::optional<Eigen::Matrix3d> between(const PixelPair& a, const PixelPair& b) const;

 private:
  using Sensitivity = Eigen::Matrix<double, 3, Eigen::Dynamic>;
  Sensitivity sensitivity(const PointTriangulation& point) const;

  Rig rig_;
  int other_;
  bool stabilised_ = false;
  Eigen::MatrixXd covariance_;  ///< of the rig, then (stabilised) of the boards' motion
};

/// Uncertainty of the depth of a point on the left optical axis due to the calibration alone (no
/// matching error).
struct DepthUncertainty {
  double range_m = 0;
  double sigma_linear_m = 0;   ///< J C Jᵀ
  double sigma_sampled_m = 0;  ///< over the draws with a positive depth
  double non_physical_share =
      0;  ///< fraction of draws with rays that do not meet in front of the rig
  /// 2.5 and 97.5 % quantiles over all draws. Draws with diverging rays count as infinitely far, so
  /// an end can be infinite.
  Interval interval_95_m{0, 0};
};

/// Linear and sampled propagation: pixels are those of the estimate, triangulated with sampled
/// rigs. Depth is not linear in the parameters, so prefer the sampled value if the two differ.
/// Throws Error unless ranges are above 0 and finite, and samples at least 2.
std::vector<DepthUncertainty> depth_uncertainty(const RigEstimate& estimate,
                                                const std::vector<double>& ranges_m,
                                                const SamplingOptions& options = {});

}  // namespace vernier
