// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/rectification/vertical_field_fit.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "calib/statistics/draw_sources.h"
#include "calib/statistics/quantile.h"
#include "calib/statistics/random.h"
#include "stereo/rectification/vertical_field.h"

namespace vernier::stereo::internal {

using namespace vernier::internal;

namespace {

using Eigen::Matrix3d;
using Eigen::RowVector3d;
using Eigen::Vector3d;

// With half the matches wrong, all triples are bad with probability 2e-9.
constexpr int triples = 150;
constexpr double near_px = 0.4;          // residual at which the cost of a match saturates
constexpr double tukey = 4.685;          // 95 % efficient for normal errors
constexpr double floor_px = 0.05;        // added to the standard deviations of alignments
constexpr double min_scale = 0.3;        // minimum; exactly equal matches would give 0
constexpr double least_curvature = 0.3;  // of A by N; near 0.9 for normal errors
constexpr int max_fit_rounds = 50;
constexpr double converged_px = 1e-6;
constexpr int min_fitted = 12;         // matches: four per coefficient …
constexpr int min_used = 20;           // consistent ones: with fewer, an outlier bends the field
constexpr double min_share = 0.35;     // of the matches, consistent ones
constexpr double max_residual_px = 1;  // of these
constexpr double widest_sd_px = 0.5;   // of dy anywhere in the image
constexpr int plenty = 40;             // corners of which …
constexpr double hardly_any = 0.1;     // … at most this fraction matches in unrelated images
constexpr double chi2_3_999 = 16.266;  // 99.9 % of χ² with three degrees of freedom

struct Problem {
  Eigen::Matrix<double, Eigen::Dynamic, 3> X;
  Eigen::VectorXd dy, inverse_sigma;

  /// Residuals relative to their standard deviations.
  Eigen::VectorXd scaled_residuals(const Vector3d& p) const {
    return (dy - X * p).cwiseProduct(inverse_sigma);
  }
};

RowVector3d row_at(const Eigen::Vector2d& at_px, const Eigen::Vector2i& size_px) {
  const Eigen::Array2d size = size_px.cast<double>().array();
  const Eigen::Array2d from_middle = (at_px.array() - 0.5 * (size - 1)) / size;
  return {1, from_middle.x(), from_middle.y()};
}

Problem problem_of(const std::vector<VerticalOffset>& offsets, const Eigen::Vector2i& size_px) {
  Problem problem;
  const auto n = static_cast<Eigen::Index>(offsets.size());
  problem.X.resize(n, 3);
  problem.dy.resize(n);
  problem.inverse_sigma.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const VerticalOffset& o = offsets[static_cast<std::size_t>(i)];
    problem.X.row(i) = row_at(o.at_px, size_px);
    problem.dy[i] = o.dy_px;
    problem.inverse_sigma[i] = 1 / std::hypot(o.sigma_px, floor_px);
  }
  return problem;
}

double median(const Eigen::VectorXd& values) {
  return quantile(std::vector<double>(values.begin(), values.end()), 0.5, QuantileKind::upper);
}

/// The field through three matches that is consistent with most others.
Vector3d best_triple(const Problem& problem) {
  Vector3d best(median(problem.dy), 0, 0);
  const auto cost_of = [&](const Vector3d& p) {
    return (problem.dy - problem.X * p).cwiseAbs().cwiseMin(near_px).squaredNorm();
  };
  double least = cost_of(best);
  RandomStream draws({.seed = 1, .source = static_cast<std::uint32_t>(DrawSource::vertical_field)});
  const auto n = static_cast<std::uint32_t>(problem.dy.size());
  for (int i = 0; i < triples; ++i) {
    Matrix3d X;
    Vector3d dy;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t pick = draws.below(n);
      X.row(k) = problem.X.row(pick);
      dy[k] = problem.dy[pick];
    }
    if (!(std::abs(X.determinant()) > 1e-2)) continue;  // duplicate or nearly collinear
    const Vector3d p = X.inverse() * dy;
    const double cost = cost_of(p);
    if (cost < least) {
      least = cost;
      best = p;
    }
  }
  return best;
}

double robust_scale(const Eigen::VectorXd& residuals) {
  return std::max(min_scale, 1.4826 * median(residuals.cwiseAbs()));
}

struct Fit {
  Vector3d p;
  double scale = 1;  ///< of the scaled residuals
  bool holds = true;
};

/// Weights 1 − (r / cs)², squared; 0 beyond.
Eigen::VectorXd tukey_weights(const Eigen::VectorXd& residuals, double scale) {
  return residuals.unaryExpr([&](double r) {
    const double u = 1 - std::pow(r / (tukey * scale), 2);
    return u > 0 ? u * u : 0;
  });
}

Fit reweighted(const Problem& problem, const Vector3d& start) {
  Fit fit{start};
  fit.scale = robust_scale(problem.scaled_residuals(start));
  for (int round = 0; round < max_fit_rounds; ++round) {
    const Eigen::VectorXd r = problem.scaled_residuals(fit.p);
    fit.scale = robust_scale(r);
    const Eigen::VectorXd w =
        tukey_weights(r, fit.scale).cwiseProduct(problem.inverse_sigma.cwiseAbs2());
    const Matrix3d N = problem.X.transpose() * w.asDiagonal() * problem.X;
    const double size = N.trace();
    if (!(N.determinant() > 1e-9 * size * size * size)) return {fit.p, fit.scale, false};
    const Vector3d p = N.inverse() * (problem.X.transpose() * w.cwiseProduct(problem.dy));
    const double moved = (p - fit.p).cwiseAbs().maxCoeff();
    fit.p = p;
    if (moved < converged_px) break;
  }
  return fit;
}

/// A⁻¹ B A⁻¹ with A = Σ ψ'(r) xxᵀ / σ², B = Σ (ψ(r) / (1 − h))² xxᵀ / σ²; the leverage h corrects
/// for residuals being smaller than errors (MacKinnon and White 1985). Where many residuals are
/// where ψ falls, A is nearly singular and says nothing; N = Σ w xxᵀ / σ² of the last step replaces
/// it.
Matrix3d covariance_of(const Problem& problem, const Fit& fit) {
  const Eigen::VectorXd r = problem.scaled_residuals(fit.p);
  const Eigen::VectorXd weight = tukey_weights(r, fit.scale);
  const Eigen::Matrix<double, Eigen::Dynamic, 3> X = problem.inverse_sigma.asDiagonal() * problem.X;
  const Eigen::VectorXd u2 = (r / (tukey * fit.scale)).cwiseAbs2();
  Matrix3d A = Matrix3d::Zero(), B = Matrix3d::Zero();
  const Matrix3d N = X.transpose() * weight.asDiagonal() * X;
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    if (u2[i] < 1) A += (1 - u2[i]) * (1 - 5 * u2[i]) * X.row(i).transpose() * X.row(i);
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix3d> of_both(A, N, Eigen::EigenvaluesOnly);
  if (!(of_both.eigenvalues()[0] > least_curvature)) A = N;
  const Matrix3d inverse = A.inverse();
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    const double h = weight[i] * (X.row(i) * inverse * X.row(i).transpose()).value();
    const double psi = weight[i] * r[i] / std::max(0.1, 1 - h);
    B += psi * psi * X.row(i).transpose() * X.row(i);
  }
  return inverse * B * inverse;
}

std::array<RowVector3d, 4> image_corners(const VerticalField& field) {
  const Eigen::Vector2i size(field.width_px, field.height_px);
  std::array<RowVector3d, 4> rows;
  for (int k = 0; k < 4; ++k) {
    rows[k] = row_at({(k % 2) * (size[0] - 1), (k / 2) * (size[1] - 1)}, size);
  }
  return rows;
}

/// The mean square of dy over the image that the field has but for two standard deviations.
double surely_px2(const VerticalField& field) {
  const Vector3d over_image(1, 1.0 / 12, 1.0 / 12);  // of the squares, x and y within ± 1/2
  const Matrix3d& C = field.covariance_px2;
  const Vector3d half_slope = over_image.cwiseProduct(field.coefficients_px);
  const double by_noise = C.diagonal().dot(over_image);
  const double sd = 2 * std::sqrt(half_slope.dot(C * half_slope));
  return field.rms_px() * field.rms_px() - by_noise - 2 * sd;
}

/// Sets the flags from the estimates.
void judge(VerticalField& field, const VerticalFieldOptions& options) {
  double widest = 0;
  for (const RowVector3d& x : image_corners(field)) {
    widest = std::max(widest, std::sqrt((x * field.covariance_px2 * x.transpose()).value()));
  }
  const double largest = field.largest_px();
  const bool agree =
      field.used >= min_share * field.matched && field.residual_px <= max_residual_px;
  field.known = agree && field.used >= min_used && widest <= widest_sd_px;
  const double chi2 =
      field.coefficients_px.dot(field.covariance_px2.inverse() * field.coefficients_px);
  field.significant = field.known && chi2 > chi2_3_999 && largest > options.min_correction_px;
  field.misaligned =
      field.significant && surely_px2(field) > options.max_rms_px * options.max_rms_px;
  field.unrectified = !agree || largest > options.band_px;
}

}  // namespace

double VerticalField::largest_px() const {
  double largest = 0;
  for (const RowVector3d& x : image_corners(*this)) {
    largest = std::max(largest, std::abs((x * coefficients_px).value()));
  }
  return largest;
}

double VerticalField::rms_px() const {
  // x and y are uniform over [-1/2, 1/2]
  const Eigen::Vector3d squares = coefficients_px.cwiseAbs2();
  return std::sqrt(squares[0] + (squares[1] + squares[2]) / 12);
}

VerticalField fit_vertical_field(const std::vector<VerticalOffset>& offsets,
                                 int corners,
                                 const Eigen::Vector2i& size_px,
                                 const VerticalFieldOptions& options) {
  VerticalField field;
  field.width_px = size_px[0];
  field.height_px = size_px[1];
  field.band_px = options.band_px;
  field.corners = corners;
  field.matched = static_cast<int>(offsets.size());
  field.unrectified = corners >= plenty && field.matched <= hardly_any * corners;
  if (field.matched < min_fitted) return field;
  const Problem problem = problem_of(offsets, size_px);
  const Fit fit = reweighted(problem, best_triple(problem));
  if (!fit.holds) return field;
  field.coefficients_px = fit.p;
  field.covariance_px2 = covariance_of(problem, fit);
  const Eigen::VectorXd scaled = problem.scaled_residuals(fit.p).cwiseAbs();
  const Eigen::VectorXd residuals = (problem.dy - problem.X * fit.p).cwiseAbs();
  std::vector<double> of_used;
  for (Eigen::Index i = 0; i < scaled.size(); ++i) {
    if (scaled[i] < tukey * fit.scale) of_used.push_back(residuals[i]);
  }
  field.used = static_cast<int>(of_used.size());
  field.residual_px = 1.4826 * median(Eigen::Map<Eigen::VectorXd>(of_used.data(), field.used));
  judge(field, options);
  return field;
}

}  // namespace vernier::stereo::internal
