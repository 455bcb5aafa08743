// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/cluster_robust_covariance.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "calib/base/decompositions.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/solver/normal_equations.h"
#include "calib/statistics/scatter_dof.h"

namespace vernier::internal {
namespace {

/// V diag(values) Vᵀ
Eigen::MatrixXd with_eigenvalues(const Eigen::MatrixXd& V, const Eigen::VectorXd& values) {
  const Eigen::MatrixXd scaled = V * values.asDiagonal();
  return scaled * V.transpose();
}

/// Aᵀ M A
Eigen::MatrixXd congruent(const Eigen::MatrixXd& M, const Eigen::MatrixXd& A) {
  const Eigen::MatrixXd MA = M * A;
  return A.transpose() * MA;
}

/// The part of a view in the estimate, corrected for its leverage.
struct Pull {
  Eigen::VectorXd u;        ///< (I − H)^(-1/2) x
  Eigen::MatrixXd missing;  ///< of E u uᵀ at a noise of 1, by directions it alone determines
};

/// For a symmetric H with eigenvalues in [0, 1]. A view that alone determines a direction
/// (eigenvalue 1) has no residual along it and its pull there says nothing; eigenvalues are limited
/// to just below 1.
Pull corrected_for_leverage(const Eigen::MatrixXd& H, const Eigen::VectorXd& x) {
  constexpr double most = 0.999;
  const SymmetricEigen eigen(0.5 * (H + H.transpose()));
  const Eigen::ArrayXd h = eigen.eigenvalues().array().max(0.0).min(1.0);
  const Eigen::ArrayXd limited = h.min(most);
  const Eigen::MatrixXd& V = eigen.eigenvectors();
  Pull pull{V * ((1 - limited).rsqrt() * (V.transpose() * x).array()).matrix(), {}};
  if (h.maxCoeff() > most) {
    // E u uᵀ = V h (1 − h) / (1 − limited) Vᵀ, and should be V h Vᵀ
    const Eigen::ArrayXd lost = h - h * (1 - h) / (1 - limited);
    pull.missing = with_eigenvalues(V, lost);
  }
  return pull;
}

/// With a prior the pulls sum to the prior's, which is no scatter.
void remove_mean(Eigen::MatrixXd& pulls) { pulls.colwise() -= pulls.rowwise().mean().eval(); }

/// Shrinkage intensity of J = Σ x_f x_fᵀ towards the target by Ledoit and Wolf.
double ledoit_wolf_intensity(const Eigen::MatrixXd& pulls,
                             const Eigen::MatrixXd& J,
                             const Eigen::MatrixXd& target) {
  const auto n = static_cast<double>(pulls.cols());
  const double spread = (J - target).squaredNorm();
  if (!(spread > 0)) return 1;
  double scatter = 0;
  for (Eigen::Index f = 0; f < pulls.cols(); ++f) {
    const Eigen::VectorXd u = pulls.col(f);
    const Eigen::MatrixXd of_one = n * u * u.transpose();
    scatter += (of_one - J).squaredNorm();
  }
  return std::min(1.0, scatter / (n * n) / spread);
}

/// Shrinkage intensity of J = Σ x_f x_fᵀ towards the target for a Gaussian x in `p` dimensions, of
/// which there are few `draws` (Chen, Wiesel, Eldar and Hero 2010, equation 23, "OAS").
double oracle_approximating_intensity(const Eigen::MatrixXd& J,
                                      const Eigen::MatrixXd& target,
                                      double p,
                                      Eigen::Index draws) {
  p = std::max(2.0, p);
  const auto n = static_cast<double>(draws);
  const double spread = (n + 1 - 2 / p) * (J - target).squaredNorm();
  if (!(spread > 0)) return 1;
  return std::min(1.0, ((1 - 2 / p) * J.squaredNorm() + J.trace() * J.trace()) / spread);
}

/// The nearest symmetric matrix whose eigenvalues are at least 1.
Eigen::MatrixXd at_least_identity(const Eigen::MatrixXd& M) {
  const SymmetricEigen eigen(0.5 * (M + M.transpose()));
  return with_eigenvalues(eigen.eigenvectors(), eigen.eigenvalues().cwiseMax(1.0));
}

/// Clusters whose noise is of one kind.
struct Kind {
  Eigen::MatrixXd pulls;    ///< one per column
  Eigen::MatrixXd missing;  ///< their sum
  Eigen::MatrixXd share;    ///< of the information, Σ H_f
};

/// Of the clusters from `begin` to before `end`; the bound is L Lᵀ.
Kind kind_of(const ReducedNormalEquations& equations,
             const Eigen::MatrixXd& L,
             Eigen::Index begin,
             Eigen::Index end) {
  const auto p = L.rows();
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(p, p);
  Kind kind{Eigen::MatrixXd(p, end - begin), none, none};
  for (Eigen::Index f = begin; f < end; ++f) {
    const Eigen::MatrixXd H = congruent(equations.frame_information[f], L);
    const Pull pull = corrected_for_leverage(H, L.transpose() * equations.scores.col(f));
    kind.pulls.col(f - begin) = pull.u;
    kind.share += H;
    if (pull.missing.size() > 0) kind.missing += pull.missing;
  }
  return kind;
}

/// Mean variance over the bound's, where the scatter shows it.
double inflation_of(const Kind& kind, const Eigen::MatrixXd& scatter) {
  const double seen = kind.share.trace() - kind.missing.trace();
  return scatter.trace() / std::max(seen, 1e-9);
}

/// The variance of the kind's part in the estimate, which the bound says is its share.
Eigen::MatrixXd shrunk_scatter(const Kind& kind) {
  const Eigen::MatrixXd scatter = kind.pulls * kind.pulls.transpose();
  const double inflation = inflation_of(kind, scatter);
  const Eigen::MatrixXd J = scatter + inflation * kind.missing;
  const Eigen::MatrixXd target = inflation * kind.share;
  const Eigen::Index clusters = kind.pulls.cols();
  const double alpha =
      std::max(ledoit_wolf_intensity(kind.pulls, J, target),
               oracle_approximating_intensity(J, target, kind.share.trace(), clusters - 1));
  return student_variance(scatter_dof(static_cast<double>(clusters))) *
         ((1 - alpha) * J + alpha * target);
}

}  // namespace

ClusterScatter scatter_of_clusters(const ReducedNormalEquations& equations,
                                   const Eigen::MatrixXd& bound) {
  const Eigen::MatrixXd L = Cholesky(bound).lower();
  Kind all = kind_of(equations, L, 0, equations.scores.cols());
  if (equations.prior_information.size() > 0) remove_mean(all.pulls);
  const double squares = all.pulls.squaredNorm();
  const double dimensions = all.share.trace() - all.missing.trace();
  return {L * all.pulls, dimensions > 0 && squares > 0 ? squares / dimensions : 1};
}

Covariance cluster_robust_covariance(const ReducedNormalEquations& equations,
                                     const Eigen::MatrixXd& bound,
                                     const std::vector<std::string>& names,
                                     const ClusterOptions& options) {
  constexpr Eigen::Index many_per_parameter = 3, least = 3;
  const auto p = bound.rows();
  const auto frames = static_cast<Eigen::Index>(equations.frame_information.size());
  if (frames < least) {
    throw Error("cluster-robust covariance", "fewer than three frames", "give more views");
  }
  const bool has_many = frames >= many_per_parameter * p;
  const Eigen::MatrixXd L = Cholesky(bound).lower();
  Eigen::MatrixXd prior_share = Eigen::MatrixXd::Zero(p, p);
  const bool has_prior = equations.prior_information.size() > 0;
  if (has_prior) prior_share = congruent(equations.prior_information, L);
  const Eigen::Index first = options.of_first_kind;
  const bool by_bound = options.bound_of == BoundOf::random_effects && !has_many;
  const bool is_mixed = !by_bound && first >= least && frames - first >= least;
  Eigen::MatrixXd shrunk;
  if (is_mixed) {
    Kind one = kind_of(equations, L, 0, first), other = kind_of(equations, L, first, frames);
    Eigen::MatrixXd pulls(p, frames);
    pulls << one.pulls, other.pulls;
    if (has_prior) remove_mean(pulls);
    one.pulls = pulls.leftCols(first);
    other.pulls = pulls.rightCols(frames - first);
    shrunk = shrunk_scatter(one) + shrunk_scatter(other);
  } else {
    Kind all = kind_of(equations, L, 0, frames);
    all.share = Eigen::MatrixXd::Identity(p, p) - prior_share;
    if (has_prior) remove_mean(all.pulls);
    shrunk = by_bound
                 ? std::max(1.0, inflation_of(all, all.pulls * all.pulls.transpose())) * all.share
                 : shrunk_scatter(all);
  }
  const Eigen::MatrixXd matrix = congruent(at_least_identity(shrunk + prior_share), L.transpose());
  return {has_many ? CovarianceKind::clustered : CovarianceKind::jackknife, names,
          0.5 * (matrix + matrix.transpose())};
}

}  // namespace vernier::internal
