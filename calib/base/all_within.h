// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace vernier::internal {

/// Whether the size of every value is at most `most`. No NaN is: of the maximum of values with a
/// NaN Eigen promises nothing.
template <typename Derived>
bool all_within(const Eigen::DenseBase<Derived>& values, double most) {
  return (values.derived().array().abs() <= most).all();
}

}  // namespace vernier::internal
