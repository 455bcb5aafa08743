// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "calib/solver/normal_equations.h"

namespace vernier::internal {

/// A covariance for few views whose residuals depend on each other within a view.
struct SmallSampleCovariance {
  Eigen::MatrixXd matrix;
  double inflation = 1;  ///< its mean variance over that of the bound, in the bound's own metric
  double shrinkage = 0;  ///< in [0, 1]: 1 is the bound's shape scaled, 0 the views' scatter alone
};

/// Each view's pull on the estimate, corrected for its leverage and shrunk towards the shape of the
/// bound C = L Lᵀ. With H_f = Lᵀ S_f L the share of view f in the information (Σ H_f = I),
///
///     u_f = (I − H_f)^(-1/2) Lᵀ g_f,    J = Σ u_f u_fᵀ
///     covariance = L [(1 − α) J + α (tr J / p) I] Lᵀ
///
/// The exponent makes J unbiased where the noise is white (bias-reduced linearisation, Bell and
/// McCaffrey 2002; with exponent −1 it is the jackknife that leaves one view out, which is too wide
/// by the leverage). J has rank F − 1 at most, so with few views it needs the shape of the bound; α
/// is the intensity of Ledoit and Wolf (2004), from the views' own scatter. A prior of information
/// P has the share G = Lᵀ P L: then I − G stands for I in the shrinkage's target, p − tr G for p,
/// and G is added. Needs at least three frames (else Error).
SmallSampleCovariance small_sample_covariance(const ReducedNormalEquations& equations,
                                              const Eigen::MatrixXd& bound);

}  // namespace vernier::internal
