// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace vernier::internal {

/// The third component of the cross product of two vectors of a plane: positive if `v` points to
/// the left of `u`, and the sine of the angle from `u` to `v` times both lengths.
inline double cross(const Eigen::Vector2d& u, const Eigen::Vector2d& v) {
  return u.x() * v.y() - u.y() * v.x();
}

}  // namespace vernier::internal
