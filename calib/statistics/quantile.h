// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "calib/error.h"

namespace vernier::internal {

/// Definitions of the quantile of n values x_0 <= … <= x_{n−1} (Hyndman and Fan, "Sample quantiles
/// in statistical packages", 1996).
enum class QuantileKind {
  lower,   ///< x_k, k = ⌊p (n − 1)⌋
  upper,   ///< x_k, k = ⌊p n⌋ (at most n − 1): of an even number of values the larger median
  linear,  ///< linear between the two values beside p (n − 1), their type 7
};

/// The p-quantile of `values`, p in [0, 1]. Throws Error if there are no values or p is out of
/// range.
template <class T>
T quantile(std::vector<T> values, double p, QuantileKind kind) {
  if (values.empty()) throw Error("quantile", "there are no values", "give at least one");
  if (!(p >= 0 && p <= 1)) throw Error("quantile", "p is not in [0, 1]", "give a p between them");
  const auto n = static_cast<double>(values.size());
  // 0.2 · 15 may lie just below 3
  const double at = kind == QuantileKind::upper ? std::min(p * n + 1e-9, n - 1) : p * (n - 1);
  const auto below = values.begin() + static_cast<std::ptrdiff_t>(at);
  std::nth_element(values.begin(), below, values.end());
  if (kind != QuantileKind::linear) return *below;
  const double part = at - std::floor(at);
  if (part == 0 || std::isinf(*below)) return *below;
  const T above = *std::min_element(below + 1, values.end());
  return above == *below ? *below : static_cast<T>(*below + part * (above - *below));
}

/// The upper median of `values`; 0 of none.
template <class T>
T median_or_zero(std::vector<T> values) {
  return values.empty() ? 0 : quantile(std::move(values), 0.5, QuantileKind::upper);
}

}  // namespace vernier::internal
