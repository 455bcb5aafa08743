// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/covariance.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include "calib/error.h"
#include "calib/scaled_root.h"

namespace vernier {
namespace {

constexpr std::pair<CovarianceKind, std::string_view> kinds[] = {
    {CovarianceKind::mvb, "mvb"},
    {CovarianceKind::clustered, "clustered"},
    {CovarianceKind::jackknife, "jackknife"},
    {CovarianceKind::prior, "prior"},
    {CovarianceKind::combined, "combined"}};

/// "right.ox_px" -> "the right centre (x)".
std::string parameter_in_words(const std::string& name) {
  static const std::map<std::string, std::string> words{
      {"f_px", "focal length"},       {"ax", "aspect ratio"},
      {"ox_px", "centre (x)"},        {"oy_px", "centre (y)"},
      {"wx_rad", "rotation about x"}, {"wy_rad", "rotation about y"},
      {"wz_rad", "rotation about z"}, {"tx_m", "position (x)"},
      {"ty_m", "position (y)"},       {"tz_m", "position (z)"}};
  const std::size_t dot = name.find('.');
  if (dot == std::string::npos) return name;
  const std::string camera = name.substr(0, dot), parameter = name.substr(dot + 1);
  const auto found = words.find(parameter);
  return "the " + camera + " " + (found != words.end() ? found->second : "distortion " + parameter);
}

double condition(const Eigen::VectorXd& eigenvalues) {
  const double least = eigenvalues.minCoeff();
  return least > 0 ? eigenvalues.maxCoeff() / least : std::numeric_limits<double>::infinity();
}

}  // namespace

std::string_view name(CovarianceKind kind) {
  for (const auto& [known, word] : kinds) {
    if (known == kind) return word;
  }
  return "";
}

CovarianceKind covariance_kind(std::string_view name) {
  for (const auto& [kind, word] : kinds) {
    if (word == name) return kind;
  }
  throw Error(fmt::format("covariance kind \"{}\"", name), "there is no such kind",
              "use mvb, clustered, jackknife, prior or combined");
}

Eigen::MatrixXd minimum_variance_bound(const ReducedNormalEquations& equations,
                                       const std::vector<std::string>& names) {
  // Scaled by what the views would say were the board's poses known: a direction that the poses
  // can imitate then shows as a small eigenvalue, however its parameters are measured.
  const Eigen::VectorXd& diagonal = equations.held_poses_diagonal;
  for (Eigen::Index i = 0; i < diagonal.size(); ++i) {
    if (!(diagonal[i] > 0)) {
      throw Error(names[i], "the observations say nothing about it", "use views that move it");
    }
  }
  const Eigen::VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * equations.information * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  if (!(eigen.eigenvalues()[0] > 1e-13 * eigen.eigenvalues()[diagonal.size() - 1])) {
    throw Error("calibration",
                "the views leave a direction free: " +
                    describe_direction(eigen.eigenvectors().col(0), names),
                "add views at other tilts and distances, or use a model with fewer parameters");
  }
  const auto n = diagonal.size();
  const Eigen::MatrixXd inverse =
      Eigen::LLT<Eigen::MatrixXd>(scaled).solve(Eigen::MatrixXd::Identity(n, n));
  const Eigen::MatrixXd C = scale.asDiagonal() * inverse * scale.asDiagonal();
  return 0.5 * (C + C.transpose());
}

Eigen::MatrixXd clustered_sandwich(const ReducedNormalEquations& equations,
                                   const Eigen::MatrixXd& bound,
                                   double frames_per_parameter) {
  const auto frames = static_cast<double>(equations.scores.cols());
  const auto parameters = static_cast<double>(bound.rows());
  if (frames < frames_per_parameter * parameters) {
    throw Error("clustered covariance",
                fmt::format("{} frames are too few for {} parameters", frames, parameters),
                fmt::format("give at least {}", std::ceil(frames_per_parameter * parameters)));
  }
  if (equations.prior_information.size() == 0) {
    const Eigen::MatrixXd influence = bound * equations.scores;
    return frames / (frames - 1) * influence * influence.transpose();
  }
  // With a prior the scores sum to its pull, which is no scatter, and it adds its own information.
  const Eigen::MatrixXd centred =
      equations.scores.colwise() - equations.scores.rowwise().mean().eval();
  const Eigen::MatrixXd influence = bound * centred;
  return frames / (frames - 1) * influence * influence.transpose() +
         bound * equations.prior_information * bound;
}

std::string describe_direction(const Eigen::VectorXd& direction,
                               const std::vector<std::string>& names) {
  std::vector<int> order(direction.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return std::abs(direction[a]) > std::abs(direction[b]); });
  // As many parameters as it takes to say four fifths of the direction, at most three.
  double said = 0;
  std::string words;
  for (std::size_t k = 0; k < std::min<std::size_t>(3, order.size()) && said < 0.8; ++k) {
    const int i = order[k];
    if (k > 0) words += direction[i] * direction[order[0]] < 0 ? " against " : " with ";
    words += parameter_in_words(names[i]);
    said += direction[i] * direction[i];
  }
  return fmt::format("{:.2f} of this direction is {}", said, words);
}

ScaledDecomposition::ScaledDecomposition(const Covariance& covariance) {
  const Eigen::MatrixXd& C = covariance.matrix;
  const auto n = C.rows();
  if (n == 0 || C.cols() != n || static_cast<Eigen::Index>(covariance.names.size()) != n) {
    throw Error("covariance", "it is not square, or its names do not match", "check the rig file");
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!(C(i, i) >= 0) || !C.row(i).allFinite()) {
      throw Error("covariance", "the variance of " + covariance.names[i] + " is not a number >= 0",
                  "check the rig file");
    }
  }
  // A parameter without variance is held: it takes no part in any direction.
  const ScaledEigen eigen(C);
  const Eigen::VectorXd& sd = eigen.deviations;
  const Eigen::MatrixXd unit = (sd * sd.transpose()).cwiseMax(std::numeric_limits<double>::min());
  if (!((C - C.transpose()).cwiseQuotient(unit).cwiseAbs().maxCoeff() < 1e-9)) {
    throw Error("covariance", "it is not symmetric", "check the rig file");
  }
  if (eigen.values[n - 1] < -1e-9 * std::max(eigen.values[0], 1.0)) {
    throw Error("covariance",
                "it is not positive semi-definite: negative variance where " +
                    describe_direction(eigen.directions.col(n - 1), covariance.names),
                "give a covariance in which no direction has a negative variance");
  }
  const Eigen::VectorXd s = eigen.values.cwiseMax(0);
  Eigen::MatrixXd U = eigen.directions;
  for (Eigen::Index k = 0; k < n; ++k) {  // sign by the largest component: one answer for all
    Eigen::Index largest_row;
    U.col(k).cwiseAbs().maxCoeff(&largest_row);
    if (U(largest_row, k) < 0) U.col(k) = -U.col(k);
    directions_.push_back(
        {s[k] / s.sum(), s[k], U.col(k), describe_direction(U.col(k), covariance.names)});
  }
  factor_ = sd.asDiagonal() * U * s.cwiseSqrt().asDiagonal();
  scaled_condition_ = condition(s);
  raw_condition_ = condition(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(C).eigenvalues());
}

}  // namespace vernier
