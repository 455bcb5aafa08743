// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace vernier::localise::internal {

/// Lines in one frame, among which another one is looked for. By columns, for a SIMD kernel that is
/// selected at run time (calib/base/instruction_set.h).
class KnownLines {
 public:
  void add(const Eigen::Vector3f& a_m, const Eigen::Vector3f& b_m, float sigma_m);

  /// Whether a line is the same as a known one, or a part of it: parallel to 10 degrees, not beyond
  /// its ends by more than 0.1 m and 15 % of the length, and no further aside than both are
  /// uncertain.
  bool contain(const Eigen::Vector3f& a_m, const Eigen::Vector3f& b_m, float sigma_m) const;

 private:
  struct Columns {
    std::size_t size = 0;
    /// An end, the direction, the length, the standard deviation; longer than `size` by whole
    /// vectors.
    std::vector<float> ax, ay, az, ux, uy, uz, length_m, sigma_m;

    void add(const Eigen::Vector3f& a_m, const Eigen::Vector3f& u, float length, float sigma);
  };
  /// Lines of one set are parallel to none of the other; those between are in both.
  Columns steep_, level_;
};

}  // namespace vernier::localise::internal
