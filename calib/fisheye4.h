// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

#include "calib/radial1.h"

namespace vernier {

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
