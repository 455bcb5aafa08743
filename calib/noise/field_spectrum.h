// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace vernier::internal {

/// |X_i − X_j|² (m²)
Eigen::MatrixXd squared_distances(const std::vector<Eigen::Vector3d>& points_m);

/// The correlation of a smooth field at corners X of a board, K_ij = exp(−|X_i − X_j|² / 2 ℓ²).
Eigen::MatrixXd field_correlation(const std::vector<Eigen::Vector3d>& points_m, double length_m);

}  // namespace vernier::internal
