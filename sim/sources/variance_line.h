// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace vernier::sim::internal {

/// A squared sample (or a product of two samples with equal expectation) and its second variance.
struct SquareSample {
  double square = 0, share = 0;
  double noise = 0;  ///< additional variance that enters its scatter but not its expectation
};

/// E[square] = own + share · other, both at least 0.
struct VarianceLine {
  double own = 0, other = 0;
};

/// Least squares weighted by the inverse variance of a square, 2 (own + share · other + noise)²,
/// iterated until the weights are consistent with the result. With `cut` above 0, squares above
/// cut² times their expectation are dropped, and the resulting loss of variance of a normal
/// distribution is corrected for. Returns zeros for fewer than two samples.
VarianceLine variance_line(const std::vector<SquareSample>& samples, double cut);

}  // namespace vernier::sim::internal
