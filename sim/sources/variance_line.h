// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace vernier::sim::internal {

/// A square (or a product of two equal things), and how much of a second variance is in it.
struct SquareSample {
  double square = 0, share = 0;
  double noise = 0;  ///< variance that its expectation does not hold and its scatter does
};

/// E[square] = own + share · other, both at least 0.
struct VarianceLine {
  double own = 0, other = 0;
};

/// Least squares weighted by the inverse variance of a square, 2 (own + share · other + noise)²,
/// repeated until the weights are those of the result. With `cut` above 0, squares above cut² times
/// their expectation are left out, and what that takes from a normal distribution's variance is
/// given back. Zeros for fewer than two samples.
VarianceLine variance_line(const std::vector<SquareSample>& samples, double cut);

}  // namespace vernier::sim::internal
