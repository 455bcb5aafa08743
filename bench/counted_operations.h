// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "calib/camera.h"

namespace vernier::counted {

/// A number that counts floating-point operations: a sum, product or quotient is one, a fused
/// multiply-add two. The formulas of a corner run on it as they do on registers.
struct Counted {
  double value = 0;
  static inline long operations = 0;

  Counted() = default;
  explicit Counted(double v) : value(v) {}
};

inline Counted counted(double value, int operations = 1) {
  Counted::operations += operations;
  return Counted(value);
}
inline Counted operator+(Counted a, Counted b) { return counted(a.value + b.value); }
inline Counted operator-(Counted a, Counted b) { return counted(a.value - b.value); }
inline Counted operator*(Counted a, Counted b) { return counted(a.value * b.value); }
inline Counted operator/(Counted a, Counted b) { return counted(a.value / b.value); }
inline Counted mul_add(Counted a, Counted b, Counted c) {
  return counted(a.value * b.value + c.value, 2);
}
inline Counted at_least(Counted a, Counted b) { return counted(std::fmax(a.value, b.value)); }
inline Counted sqrt(Counted a) { return counted(std::sqrt(a.value)); }
inline Counted atan(Counted a) { return counted(std::atan(a.value)); }

#include "calib/camera/corner_formulas.inc"

/// Operations of one corner's rows of the system.
template <class Model>
long row_operations() {
  CornerView<Model, Counted> view;
  for (Counted& r : view.R) r = Counted(0.5);
  for (Counted& k : view.k) k = Counted(0.1);
  view.t[2] = view.fx = view.fy = Counted(1);
  const Counted X[3] = {Counted(0.1), Counted(0.2), Counted(0)}, shape[2] = {};
  const Counted pixel[2] = {};
  Counted u[24], v[24];
  Counted::operations = 0;
  corner_rows<false>(Model{}, view, X, shape, Counted(1), pixel, u, v);
  return Counted::operations;
}

/// Operations of one corner in the sums: a fused multiply-add for each product of two columns of a
/// row.
template <class Model>
long sum_operations() {
  const long columns = static_cast<long>(Model::distortion_names.size()) + 9;
  return 2 * 2 * columns * (columns + 1) / 2;
}

}  // namespace vernier::counted
