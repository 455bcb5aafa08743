// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "calib/covariance.h"
#include "calib/rig.h"

namespace vernier::internal {

/// How far rigs drawn from a covariance are from the linear model of their images, which no choice
/// of coordinates mends (the intrinsic curvature of D. M. Bates and D. G. Watts, "Relative
/// curvature measures of nonlinearity", 1980): with δ a draw and c the coordinates of its rig
/// (stable_coordinates.h), the mean of (c − δ)ᵀ C⁺ (c − δ) over the rank of C and 64 draws. 0 for a
/// linear model. Infinite if a draw has no rig with coordinates.
double covariance_curvature(const Rig& rig, const Covariance& covariance);

/// Curvature above which a covariance does not describe the errors. Solved again with new noise,
/// calibrations of lenses of 6° to 24° had squared distances of 1.0 to 1.1 times their expectation
/// below 0.002, 1.5 to 1.7 at 0.01, and 2.4 to 25 above 0.04.
inline constexpr double largest_curvature = 0.02;

/// The trust warning of a larger one.
std::optional<std::string> curvature_warning(const Rig& rig, const Covariance& covariance);

}  // namespace vernier::internal
