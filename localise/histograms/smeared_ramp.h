// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace vernier::localise::internal {

/// A uniform density over [low, high] convolved with a Gaussian of standard deviation sigma > 0.
/// All have the same unit.
struct SmearedRamp {
  double low = 0, high = 0, sigma = 1;
};

/// The part of it below x: the integral of [Φ((x-low)/σ) - Φ((x-high)/σ)] / (high - low).
double mass_below(double x, const SmearedRamp& ramp);

/// Adds `mass` of the magnitudes of a ramp to `bins`, an even division of [0, max): what is below
/// zero is reflected, what is beyond max is lost. Computed analytically for each bin. A ramp beyond
/// max, or with numbers that are not finite or exceed 1e100, adds nothing.
void add_magnitudes(std::span<float> bins, double max, const SmearedRamp& ramp, double mass);

/// The same with signs: `bins` is an even division of [-max, max).
void add_signed(std::span<float> bins, double max, const SmearedRamp& ramp, double mass);

}  // namespace vernier::localise::internal
