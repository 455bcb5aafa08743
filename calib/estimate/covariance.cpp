// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/covariance.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "calib/base/all_within.h"
#include "calib/base/decompositions.h"
#include "calib/error.h"
#include "calib/statistics/scaled_root.h"

namespace vernier {

using namespace internal;

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
  throw Error(fmt::format("covariance kind \"{}\"", name), "unknown kind",
              "supported: mvb, clustered, jackknife, prior, combined");
}

std::string describe_direction(const Eigen::VectorXd& direction,
                               const std::vector<std::string>& names) {
  std::vector<int> order(direction.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return std::abs(direction[a]) > std::abs(direction[b]); });
  // As many parameters as explain four fifths of the direction, at most three.
  double explained = 0;
  std::string words;
  for (std::size_t k = 0; k < std::min<std::size_t>(3, order.size()) && explained < 0.8; ++k) {
    const int i = order[k];
    if (k > 0) words += direction[i] * direction[order[0]] < 0 ? " against " : " with ";
    words += parameter_in_words(names[i]);
    explained += direction[i] * direction[i];
  }
  return fmt::format("{:.2f} of this direction is {}", explained, words);
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
  // A parameter without variance is held and takes part in no direction.
  const ScaledEigen eigen(C);
  const Eigen::VectorXd& sd = eigen.deviations;
  const Eigen::MatrixXd unit = (sd * sd.transpose()).cwiseMax(std::numeric_limits<double>::min());
  if (!all_within((C - C.transpose()).cwiseQuotient(unit), 1e-9)) {
    throw Error("covariance", "it is not symmetric", "check the rig file");
  }
  if (eigen.values[n - 1] < -1e-9 * std::max(eigen.values[0], 1.0)) {
    throw Error("covariance",
                "it is not positive semi-definite: negative variance where " +
                    describe_direction(eigen.directions.col(n - 1), covariance.names),
                "give a covariance in which no direction has a negative variance");
  }
  const Eigen::VectorXd s = eigen.values.cwiseMax(0);
  const double total = s.sum();
  Eigen::MatrixXd U = eigen.directions;
  for (Eigen::Index k = 0; k < n; ++k) {  // sign by the largest component: one answer for all
    Eigen::Index largest_row;
    U.col(k).cwiseAbs().maxCoeff(&largest_row);
    if (U(largest_row, k) < 0) U.col(k) = -U.col(k);
    directions_.push_back({total > 0 ? s[k] / total : 0, s[k], U.col(k),
                           describe_direction(U.col(k), covariance.names)});
  }
  factor_ = sd.asDiagonal() * U * s.cwiseSqrt().asDiagonal();
  scaled_condition_ = condition(s);
  raw_condition_ = condition(SymmetricEigen(C).eigenvalues());
}

}  // namespace vernier
