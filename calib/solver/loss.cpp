// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/loss.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vernier::internal {

Loss balanced(LossShape shape, double limit) {
  // Moments of the standard normal within the limit.
  const double c = limit, inside = std::erf(c / std::numbers::sqrt2);
  const double edge = 2 * c * std::exp(-0.5 * c * c) / std::sqrt(2 * std::numbers::pi);
  const double m2 = inside - edge, m4 = 3 * inside - edge * (c * c + 3);
  if (shape == LossShape::square) return {};
  if (shape == LossShape::huber) return {shape, limit, 1 / inside};
  return {shape, limit, 1 / (inside - 6 * m2 / (c * c) + 5 * m4 / (c * c * c * c))};
}

double cost_of(const Loss& loss, double r) {
  const double c = loss.limit, a = std::abs(r);
  if (loss.shape == LossShape::square || (loss.shape == LossShape::huber && a <= c)) {
    return loss.gain * r * r;
  }
  if (loss.shape == LossShape::huber) return loss.gain * c * (2 * a - c);
  const double t = std::max(0.0, 1 - r * r / (c * c));
  return loss.gain * c * c / 3 * (1 - t * t * t);
}

double weight_of(const Loss& loss, double r) {
  const double c = loss.limit, a = std::abs(r);
  if (loss.shape == LossShape::square || (loss.shape == LossShape::huber && a <= c)) {
    return loss.gain;
  }
  if (loss.shape == LossShape::huber) return loss.gain * c / a;
  const double t = std::max(0.0, 1 - r * r / (c * c));
  return loss.gain * t * t;
}

double curvature_of(const Loss& loss, double r) {
  const double c = loss.limit, a = std::abs(r);
  if (loss.shape == LossShape::square) return loss.gain;
  if (loss.shape == LossShape::huber) return a <= c ? loss.gain : 0;
  const double share = r * r / (c * c), t = std::max(0.0, 1 - share);
  return loss.gain * t * (1 - 5 * share);
}

}  // namespace vernier::internal
