// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/loss.h"

#include <algorithm>
#include <cmath>

namespace vernier {

double cost_of(const Loss& loss, double r) {
  const double c = loss.limit, a = std::abs(r);
  if (loss.shape == LossShape::square || (loss.shape == LossShape::huber && a <= c)) return r * r;
  if (loss.shape == LossShape::huber) return c * (2 * a - c);
  const double t = std::max(0.0, 1 - r * r / (c * c));
  return c * c / 3 * (1 - t * t * t);
}

double weight_of(const Loss& loss, double r) {
  const double c = loss.limit, a = std::abs(r);
  if (loss.shape == LossShape::square || (loss.shape == LossShape::huber && a <= c)) return 1;
  if (loss.shape == LossShape::huber) return c / a;
  const double t = std::max(0.0, 1 - r * r / (c * c));
  return t * t;
}

}  // namespace vernier
