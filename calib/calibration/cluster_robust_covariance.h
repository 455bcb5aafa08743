// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/covariance.h"
#include "calib/solver/normal_equations.h"

namespace vernier::internal {

/// What noise a minimum variance bound is of.
enum class BoundOf { white_noise, random_effects };

struct ClusterOptions {
  BoundOf bound_of = BoundOf::white_noise;
  /// Clusters that come first and whose noise is of another kind than that of the rest, as frames
  /// of a board before pairs of images; all or none of them: there is one kind.
  Eigen::Index of_first_kind = 0;
};

/// Covariance for real images, where residuals of one frame (or image pair, or cell of one: a
/// cluster) are correlated.
///
/// The contribution of each cluster to the estimate, corrected for its leverage and shrunk towards
/// the shape of the bound C = L Lᵀ, the inverse of the equations' information. With H_f = Lᵀ S_f L
/// the fraction of cluster f in the information (Σ H_f = I),
///
///     u_f = (I − H_f)^(-1/2) Lᵀ g_f,    J = Σ u_f u_fᵀ
///     covariance = ν / (ν − 2) L [(1 − α) J + α (tr J / p) I] Lᵀ,    ν = 4 (F − 1)
///
/// The exponent makes J unbiased for white noise (bias-reduced linearisation, Bell and McCaffrey
/// 2002; with exponent −1 it is the leave-one-view-out jackknife, which is too wide by the
/// leverage). J alone, the sandwich of White (1980) and of Liang and Zeger (1986), has rank F − 1
/// at most and is far from the truth in some directions long after: at three clusters per
/// parameter errors lie twice as far out, squared, as it states. α is the larger of the intensities
/// of Ledoit and Wolf (2004), from the scatter of the clusters, and of Chen, Wiesel, Eldar and Hero
/// (2010), which does not believe the scatter of three or four; both fall with their number. The
/// factor is the variance of Student's t with ν degrees of freedom, since the scale is a mean
/// square of few pulls; 4 a cluster was chosen on simulated sets, between smooth errors (3) and
/// white noise (6). A direction that one cluster alone determines (an eigenvalue of H_f of 1), as
/// the pose of a camera that shares a single frame with the others, has no scatter: tr J / p is
/// over the other directions, and J has it there. A prior of information P has the fraction G = Lᵀ
/// P L: then the shrinkage target uses I − G instead of I and p − tr G instead of p, and G is
/// added.
///
/// The scatter of few clusters may by chance be less than the bound, which no noise undercuts: in
/// the directions in which the covariance V is below C it is set to C (eigenvalues of L⁻¹ V L⁻ᵀ of
/// at least 1).
///
/// Clusters of two kinds, each with three or more, have their own J, α and tr J over the dimensions
/// that they determine, and the sum of both is the covariance.
///
/// With random effects the bound already has what the coordinates of a frame share, and is nearly
/// the truth where J, of fewer than three frames per parameter, is far from it in most directions:
/// then α = 1 and tr J / p is taken as 1 where it is less.
///
/// The kind is `clustered` with at least three clusters per parameter, `jackknife` with fewer.
/// Throws Error for fewer than three clusters.
Covariance cluster_robust_covariance(const ReducedNormalEquations& equations,
                                     const Eigen::MatrixXd& bound,
                                     const std::vector<std::string>& names,
                                     const ClusterOptions& options = {});

/// The scatter of clusters as it is, without shrinkage.
struct ClusterScatter {
  /// What each cluster contributes to the estimate, L u_f, one per column: the sum of their squares
  /// is the variance of the data's part in it; 0 along a direction that one cluster alone
  /// determines.
  Eigen::MatrixXd contributions;
  double inflation = 1;  ///< its mean over the bound's, where there is scatter
};

ClusterScatter scatter_of_clusters(const ReducedNormalEquations& equations,
                                   const Eigen::MatrixXd& bound);

}  // namespace vernier::internal
