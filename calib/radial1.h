// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>

namespace vernier {

/// The distorted position of a normalised point and its derivatives.
template <int N>
struct Distorted {
  Eigen::Vector2d x;                 ///< distorted normalised coordinates
  Eigen::Matrix2d by_x;              ///< d x_d / d x_u
  Eigen::Matrix<double, 2, N> by_k;  ///< d x_d / d k
};

/// No distortion at all.
struct Pinhole {
  static constexpr std::string_view name = "pinhole";
  static constexpr std::array<std::string_view, 0> distortion_names{};
  static Distorted<0> distort(const Eigen::Vector2d& x, const double* k);
};

/// One radial coefficient, the model of Tina Memo 2017-001: x_d = x_u (1 + k1 r²).
struct Radial1 {
  static constexpr std::string_view name = "radial1";
  static constexpr std::array<std::string_view, 1> distortion_names{"k1"};
  static Distorted<1> distort(const Eigen::Vector2d& x, const double* k);
};

}  // namespace vernier
