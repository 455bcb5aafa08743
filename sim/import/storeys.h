// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/import/mesh.h"

namespace vernier::sim::internal {

inline constexpr double lowest_storey_m = 2.2;  ///< from floor to floor

/// Heights of the floors of a building by its joined faces (convex_faces), in metres, z up,
/// ascending: where many walls (upright surfaces of at least 1.5 m) begin, at least 2.2 m above
/// each other; that of the largest level surface that faces up, lies up to 0.1 m below or 0.4 m
/// above them and is a quarter as large as their plan's bounding box, if there is one. Those
/// without, above the highest storey that has one, are storeys only if most of them end level below
/// such a surface, which may face down: else they are gables and parapets. And level surface by
/// which walls of two storeys pass, and which is half as large as the floor below: façades are
/// often one face, and so are walls that stand on each other without a slab. Empty without walls.
std::vector<double> floor_heights_m(const std::vector<Polygon>& faces);

}  // namespace vernier::sim::internal
