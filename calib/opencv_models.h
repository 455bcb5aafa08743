// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

#include "calib/radial1.h"

namespace vernier {

/// The Brown–Conrady models with OpenCV's order and definition of the coefficients:
///
///     g   = (1 + k1 r² + k2 r⁴ + k3 r⁶) / (1 + k4 r² + k5 r⁴ + k6 r⁶)
///     x_d = x g + 2 p1 x y + p2 (r² + 2 x²)
///     y_d = y g + p1 (r² + 2 y²) + 2 p2 x y
///
/// with coefficients that a model does not list equal to zero. Brown, "Close-range camera
/// calibration" (1971); the rational form is OpenCV's.
struct OpenCv4 {
  static constexpr std::string_view name = "opencv4";
  static constexpr std::array<std::string_view, 4> distortion_names{"k1", "k2", "p1", "p2"};
  static Distorted<4> distort(const Eigen::Vector2d& x, const double* k);
};

struct OpenCv5 {
  static constexpr std::string_view name = "opencv5";
  static constexpr std::array<std::string_view, 5> distortion_names{"k1", "k2", "p1", "p2", "k3"};
  static Distorted<5> distort(const Eigen::Vector2d& x, const double* k);
};

struct OpenCv8 {
  static constexpr std::string_view name = "opencv8";
  static constexpr std::array<std::string_view, 8> distortion_names{"k1", "k2", "p1", "p2",
                                                                    "k3", "k4", "k5", "k6"};
  static Distorted<8> distort(const Eigen::Vector2d& x, const double* k);
};

}  // namespace vernier
