// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calib/rig.h"

namespace vernier {

/// One direction in parameter space, and how the data improved it.
struct ObservedDirection {
  double sd_ratio = 1;        ///< standard deviation after the data over that before
  Eigen::VectorXd direction;  ///< unit, in the prior's standard deviations
  std::string description;
};

/// How much of a targetless calibration comes from its data and how much from its prior.
struct Observability {
  std::vector<ObservedDirection> directions;  ///< most improved first
  double from_data = 0;  ///< number of parameters determined by the data, tr(I − C C_0⁻¹)
  int improved = 0;      ///< directions known at least twice as well as before
  int unchanged = 0;     ///< directions whose standard deviation fell by less than a tenth
  /// The scale direction n (T → s T, all else fixed), which no pair can observe: nᵀ C⁻¹ n over nᵀ
  /// C_0⁻¹ n, 1 for any data.
  double scale_information_ratio = 1;
  double baseline_sd_before_m = 0, baseline_sd_after_m = 0;  ///< of the length |T|

  /// Whether the data determine less than half of the parameters.
  bool is_prior_dominated() const { return 2 * from_data < static_cast<double>(directions.size()); }
};

/// The spectrum of C_0^(-1/2) C C_0^(-1/2), C_0 = `before` and C = `after` in the tangent of `rig`
/// over the parameters `names`. Throws Error if `before` is not positive definite.
Observability observability(const Rig& rig,
                            const std::vector<std::string>& names,
                            const Eigen::MatrixXd& before,
                            const Eigen::MatrixXd& after);

/// The directions of the rig's tangent that matched pairs cannot observe, one per column, from
/// their analytic form. A parameter change that leaves the distortion alone multiplies the rays of
/// a camera by a matrix, X → (I + s M) X, and changes the essential matrix E = [T]x R of X_rᵀ E X_l
/// by E M_l or M_rᵀ E. These changes are
///
///     f, ax, ox, oy             of a lens whose distortion coefficients are all zero
///     f with k1² k2⁴ p1 p2 k3⁶… of a distorted lens (the same lens at another scale); none of
///     `fisheye4`
///
/// and the six of the pose. Unobservable is every combination that keeps E up to scale, the scale T
/// → s T always; for a scene on the plane n·X = 1 (left frame, n in 1/m) every one that changes E
/// to H⁻ᵀ [v]x for some v, H = R + T nᵀ the plane's homography.
Eigen::MatrixXd unobservable_directions(const Rig& rig,
                                        const std::optional<Eigen::Vector3d>& plane = {});

}  // namespace vernier
