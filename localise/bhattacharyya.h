// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

/// Similarity and distances of histograms p and q by the Bhattacharyya coefficient
///
///     B = Σ_k √(p_k q_k),  Σ p = Σ q = 1,
///
/// the cosine of the angle between the vectors of roots. The roots of counts are about equally
/// noisy (standard deviation 1/2), so that B weighs all bins alike and, other than chi-squared, has
/// no singularity at empty ones. Bhattacharyya, "On a measure of divergence between two statistical
/// populations", Bulletin of the Calcutta Mathematical Society 35, 1943; Thacker, Aherne and
/// Rockett, "The Bhattacharyya metric as an absolute similarity measure for frequency coded data",
/// Kybernetika 34, 1998.
namespace vernier::localise {

/// B of two histograms, in [0, 1]: 1 if they are proportional, 0 if they share no bin or one is
/// empty. They need not be normalised. Throws Error if they differ in size or have entries that are
/// negative or not finite.
double bhattacharyya_coefficient(const Eigen::Ref<const Eigen::VectorXd>& p,
                                 const Eigen::Ref<const Eigen::VectorXd>& q);

// Distances by the coefficient; what rounding brings above 1 counts as 1. All are 0 for B = 1.

/// √(1 - B), in [0, 1]; a metric. Hellinger, Journal für die reine und angewandte Mathematik 136,
/// 1909.
double hellinger_distance(double coefficient);

/// √(Σ (√p - √q)²) = √(2 - 2B), in [0, √2]; a metric, the distance between the vectors of roots.
/// Matusita, Annals of Mathematical Statistics 26, 1955.
double matusita_distance(double coefficient);

/// -ln B, in [0, ∞]; no metric, but it adds up over independent dimensions. Bhattacharyya 1943.
double bhattacharyya_distance(double coefficient);

/// Mean B of two histograms of the same distribution, of n_p and n_q independent counts in
/// `occupied_bins` bins K:
///
///     E[B] ≈ 1 - (K - 1)/8 (1/n_p + 1/n_q),
///
/// to first order in 1/n, from E[√(n_k)] ≈ √(E n_k) (1 - var(n_k) / (8 E²n_k)). It holds if bins
/// have several counts; at least 0. A fixed threshold on B therefore rejects equal lines with few
/// counts more often than equal lines with many: compare B with what can be expected. Entries of
/// histograms that are weighted or blurred are fewer counts than their mass.
double expected_coefficient(int occupied_bins, double n_p, double n_q);

}  // namespace vernier::localise
