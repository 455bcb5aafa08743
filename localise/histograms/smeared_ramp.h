// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace vernier::localise::internal {

/// Adds to `bins`, an even division of [0, max), the mass of a uniform density over [low, high]
/// convolved with a Gaussian of standard deviation sigma > 0, computed analytically per bin. Mass
/// beyond max is lost; mass below zero is reflected, because a distance cannot be negative. `max`,
/// `low`, `high`, `sigma` have the same unit.
void add_smeared_ramp(
    std::span<float> bins, double max, double low, double high, double sigma, double mass);

/// Mass of the blurred uniform density below x: the integral of
/// [Φ((x-low)/σ) - Φ((x-high)/σ)] / (high - low).
double smeared_ramp_cdf(double x, double low, double high, double sigma);

}  // namespace vernier::localise::internal
