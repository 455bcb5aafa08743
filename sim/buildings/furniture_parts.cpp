// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/buildings/furniture_parts.h"

#include <cstddef>

#include "sim/buildings/wire_shapes.h"

namespace vernier::sim::internal {

void drawers(double x0, double x1, double y, const std::vector<double>& z, Shapes& s) {
  for (std::size_t k = 0; k + 1 < z.size(); ++k) {
    s.upright_rectangle(x0, z[k] + 0.01, x1, z[k + 1] - 0.01, y);
    const double middle = (x0 + x1) / 2, up = z[k + 1] - 0.05;
    s.line({middle - 0.06, y + 0.015, up}, {middle + 0.06, y + 0.015, up});
  }
}

void leaves(double width, double z0, double z1, double depth, Shapes& s) {
  const double middle = width / 2, grip = (z0 + z1) / 2;
  s.upright_rectangle(0.02, z0, middle - 0.005, z1, depth + 0.005);
  s.upright_rectangle(middle + 0.005, z0, width - 0.02, z1, depth + 0.005);
  for (const double x : {middle - 0.04, middle + 0.04}) {
    s.line({x, depth + 0.02, grip - 0.08}, {x, depth + 0.02, grip + 0.08});
  }
}

}  // namespace vernier::sim::internal
