// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/odometry/pair_projection.h"

namespace vernier::localise::internal {

/// A corner measured at two moments, with a first guess of its point.
struct LinkedCorner {
  PairPixels from_px, to_px;
  Eigen::Matrix4d from_whitening, to_whitening;  ///< W with Wᵀ W the inverse of the covariance
  Eigen::Vector3d x_from_m;                      ///< left camera's frame at the earlier moment
};

/// The rigs as they are believed to be at both moments: of a drive they are one.
struct StepRigs {
  const Rig& from;
  const Rig& to;
};

/// The directions in which a motion may change: columns in the tangent of retract().
using FloorBasis = Eigen::Matrix<double, 6, 3>;

struct RefinedStep {
  Pose T_from_to;
  std::vector<Eigen::Vector3d> x_from_m;  ///< one per corner
  std::vector<double> chi2;               ///< one per corner
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();  ///< reduced

  double total_chi2() const;
};

/// Minimises the reprojection error of the corners at both moments over the motion and their
/// points; over the motions of a basis only, if one is given. std::nullopt if a point gets behind a
/// camera, or the corners do not determine the motion.
std::optional<RefinedStep> refine_step(const StepRigs& rigs,
                                       const std::vector<LinkedCorner>& corners,
                                       const Pose& T_from_to,
                                       int max_iterations,
                                       const FloorBasis* within = nullptr);

/// What the noise of a corner does to a refined motion, in the tangent of retract() (rad, m).
struct CornerInfluence {
  /// Of its pixels at either moment, as it is stated but for χ²/dof: the square is its covariance.
  Eigen::Matrix<double, 6, 4> from, to;
  Eigen::Matrix<double, 6, 1> residual;  ///< as its residuals show it
};

/// The parts of the covariance of a refined motion, Σ from fromᵀ + to toᵀ + residual residualᵀ:
///
///     C = H⁻¹ (n₀ χ²/dof H + n Σ g gᵀ) H⁻¹ / (n₀ + n),   g = (I − M H⁻¹)⁻¹ Aᵀ Q r
///
/// with r the whitened residuals of a corner, A their derivatives by the motion, Q what eliminates
/// its point, M = Aᵀ Q A and H = Σ M. The second part is the sandwich with each corner left out
/// once (HC3: MacKinnon and White, J. Econometrics 29, 1985): it holds whatever the noise of a
/// corner is made of, while χ²/dof, the first, holds only if that is as stated but for one factor.
/// A motion sideways is as uncertain as what shifts in both eyes alike, which the residuals hardly
/// show. n₀ = 20 corners' worth of the first keep the second sound for few corners.
/// One per corner.
std::vector<CornerInfluence> corner_influences(const Rig& rig,
                                               const std::vector<LinkedCorner>& corners,
                                               const RefinedStep& step);

/// Derivative of the minimum by the rig's parameters, with the measurements fixed: by the implicit
/// function theorem, to first order in the residuals.
Eigen::Matrix<double, 6, Eigen::Dynamic> step_by_rig(const Rig& rig,
                                                     const std::vector<LinkedCorner>& corners,
                                                     const RefinedStep& step);

}  // namespace vernier::localise::internal
