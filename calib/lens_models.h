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

/// Kannala and Brandt's equidistant fisheye as OpenCV writes it, on normalised coordinates:
///
///     θ = atan(r),  θ_d = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸),  x_d = x θ_d / r
///
/// "A generic camera model and calibration method" (2006). Points at 90° and beyond have no
/// normalised coordinates and are outside this model.
struct Fisheye4 {
  static constexpr std::string_view name = "fisheye4";
  static constexpr std::array<std::string_view, 4> distortion_names{"k1", "k2", "k3", "k4"};
  static Distorted<4> distort(const Eigen::Vector2d& x, const double* k);
};

}  // namespace vernier
