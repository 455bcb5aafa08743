// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/statistics/confidence_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "calib/error.h"
#include "calib/interval.h"

namespace vernier::internal {

namespace {

/// λ of each value, from those before it.
std::vector<double> bets(std::span<const double> values, double alpha) {
  std::vector<double> lambdas;
  lambdas.reserve(values.size());
  constexpr double first_square = 0.03;
  double sum = 0, squares = first_square, variance = first_square;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto t = static_cast<double>(i + 1);
    lambdas.push_back(std::sqrt(2 * std::log(2 / alpha) / (variance * t * std::log(1 + t))));
    sum += values[i];
    const double mean = sum / t;
    squares += (values[i] - mean) * (values[i] - mean);
    variance = squares / (t + 1);
  }
  return lambdas;
}

/// Logarithm of the capital of who bets that the mean is above m.
double log_capital(std::span<const double> values, const std::vector<double>& lambdas, double m) {
  constexpr double most = 0.9;
  double log = std::log(0.5);
  for (std::size_t i = 0; i < values.size(); ++i) {
    log += std::log1p(std::min(lambdas[i], most / m) * (values[i] - m));
  }
  return log;
}

/// The smallest mean that is not ruled out; the capital falls as m grows.
double lowest(std::span<const double> values, const std::vector<double>& lambdas, double alpha) {
  constexpr int halvings = 60;
  const double ruin = std::log(1 / alpha);
  double low = 0, high = 1;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (log_capital(values, lambdas, middle) >= ruin ? low : high) = middle;
  }
  return low;
}

}  // namespace

Interval confidence_sequence(std::span<const double> values, double confidence) {
  if (!(confidence > 0 && confidence < 1)) {
    throw Error("confidence sequence", fmt::format("a confidence of {}", confidence),
                "give one between 0 and 1");
  }
  std::vector<double> mirrored;
  for (const double x : values) {
    if (!(x >= 0 && x <= 1)) {
      throw Error("confidence sequence", fmt::format("a value of {}", x), "give values in [0, 1]");
    }
    mirrored.push_back(1 - x);
  }
  if (values.empty()) return {0, 1};
  const double alpha = 1 - confidence;
  const std::vector<double> lambdas = bets(values, alpha);  // the same of 1 - x
  return {lowest(values, lambdas, alpha), 1 - lowest(mirrored, lambdas, alpha)};
}

}  // namespace vernier::internal
