// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/noise/corner_noise.h"
#include "calib/noise/linear_frames.h"
#include "calib/noise/mixed_model.h"

namespace vernier::internal {

/// The gradient of −2 l by ln w, ln g and ln ℓ, from the mixed model equations (Harville 1977;
/// Searle, Casella and McCulloch 1992, chapter 8). With ε = r + A z + X x what is left of the
/// corners of a view in one coordinate, given the data, and N = Σ E[ε εᵀ] over those of a point
/// set, m in number,
///
///     ∂(−2 l)/∂θ = Σ_sets tr(∂C/∂θ (m C⁻¹ − C⁻¹ N C⁻¹))
///
/// and for a random effect u of variance s², with E[u²] = Var(u) + û²,
///
///     ∂(−2 l)/∂ln s = 2 Σ (1 − E[u²] / s²)
///
/// Variances are of the inverse of the equations: S⁻¹ for z, −S⁻¹ H T⁻¹ for z with x, and
/// T⁻¹ + T⁻¹ Hᵀ S⁻¹ H T⁻¹ for x. `S_inverse` and `z` at the solution. In the order of CornerNoise,
/// the shape's left at zero.
struct LikelihoodGradient {
  Eigen::Vector3d field = Eigen::Vector3d::Zero();   ///< by ln w, ln g and ln ℓ
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();  ///< by ln s_r, ln s_t and ln s_b
};

LikelihoodGradient likelihood_gradient(const LinearFrames& linear,
                                       const std::vector<FieldCovariance>& fields,
                                       const std::vector<FrameEquations>& frames,
                                       const Eigen::MatrixXd& S_inverse,
                                       const Eigen::VectorXd& z,
                                       const CornerNoise& noise);

}  // namespace vernier::internal
