// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace vernier::localise::internal {

/// Adds to `bins`, which divide [0, max) evenly, the mass of a uniform density over [low, high]
/// blurred by a Gaussian of standard deviation sigma > 0: analytically, bin by bin. Mass beyond
/// either end of the bins is lost, but for distances: what the blur would carry below zero is
/// reflected, for a distance cannot be negative. `max`, `low`, `high`, `sigma` share a unit.
void add_smeared_ramp(
    std::span<float> bins, double max, double low, double high, double sigma, double mass);

/// Mass that the blurred uniform density has below x: the integral of
/// [Φ((x-low)/σ) - Φ((x-high)/σ)] / (high - low).
double smeared_ramp_cdf(double x, double low, double high, double sigma);

}  // namespace vernier::localise::internal
