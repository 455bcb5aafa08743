// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace vernier::internal {

/// Contribution of a residual r, in standard deviations, to the cost.
enum class LossShape {
  square,  ///< r²
  huber,   ///< r² up to the limit c, then 2 c |r| − c² (Huber 1964)
  tukey    ///< c²/3 (1 − (1 − r²/c²)³), constant from c on (Beaton and Tukey 1974)
};
struct Loss {
  LossShape shape = LossShape::square;
  double limit = 0;  ///< c
  double gain = 1;   ///< multiplies ρ
};

/// The loss with the gain that makes its mean second derivative over standard normal residuals
/// equal to that of r². Residuals then have the right weight against a quadratic prior; an unscaled
/// robust loss gives them less (Tukey's at 5 a fifth less).
Loss balanced(LossShape shape, double limit);

/// ρ(r), its weight ρ'(r) / 2r, and ρ''(r) / 2, which Tukey's loss takes below zero.
double cost_of(const Loss& loss, double r);
double weight_of(const Loss& loss, double r);
double curvature_of(const Loss& loss, double r);

}  // namespace vernier::internal
