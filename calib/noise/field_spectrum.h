// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace vernier::internal {

/// The correlation of a smooth field at corners X of a board, K_ij = exp(−|X_i − X_j|² / 2 ℓ²), as
/// U Λ Uᵀ, and its derivative by ln ℓ in that basis, Uᵀ (K ∘ |X_i − X_j|² / ℓ²) U.
struct FieldSpectrum {
  Eigen::MatrixXd U;
  Eigen::VectorXd values;  ///< Λ, not below 0
  Eigen::MatrixXd by_log_length;
};

Eigen::MatrixXd field_correlation(const std::vector<Eigen::Vector3d>& points_m, double length_m);

FieldSpectrum field_spectrum(const std::vector<Eigen::Vector3d>& points_m, double length_m);

}  // namespace vernier::internal
