// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/buildings/wire_shapes.h"

namespace vernier::sim::internal {

/// Fronts of drawers, one between each height in `z_m` and the next, from `x0_m` to `x1_m` in the
/// plane y = `y_m`, with a handle each.
void drawers(double x0_m, double x1_m, double y_m, const std::vector<double>& z_m, Shapes& shapes);

/// Two leaves with a handle each, on the front of a box of this width and depth.
void leaves(double width_m, double z0_m, double z1_m, double depth_m, Shapes& shapes);

}  // namespace vernier::sim::internal
