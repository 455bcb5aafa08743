// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/noise/corner_noise.h"
#include "calib/noise/linear_frames.h"
#include "calib/noise/mixed_model.h"
#include "calib/noise/scaled_factor.h"

namespace vernier::internal {

/// The average of observed and expected information of −2 l by the logarithms of the components
/// (Gilmour, Thompson and Cullis 1995),
///
///     I_ij = q_iᵀ P q_j,   q_i = ∂V/∂θ_i P r
///
/// With e = W ε = P r (calib/noise/likelihood_gradient.h), q is 2 w² e, 2 g² K e and g² ∂K/∂ln ℓ e,
/// and for a random effect u with columns U it is −2 U û, since û = −Σ_u Uᵀ P r. P q is that of the
/// mixed model equations with q in place of r. `S` and `z` of the solution; `shape_m`: the whole
/// shape û. In the order w, g, ℓ, s_r, s_t, s_b, b, h, zero for parts that are not there.
Eigen::Matrix<double, 8, 8> average_information(const LinearFrames& linear,
                                                const std::vector<FieldCovariance>& fields,
                                                const std::vector<FrameEquations>& frames,
                                                const ScaledFactor& S,
                                                const Eigen::VectorXd& z,
                                                const Eigen::VectorXd& shape_m,
                                                const CornerNoise& noise);

}  // namespace vernier::internal
