// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/import/mesh.h"

namespace vernier::sim::internal {

/// The triangles of a welded mesh as fewer convex, planar polygons (to 0.5 mm): neighbours in a
/// plane are joined over their longest common edges first (after Hertel and Mehlhorn, "Fast
/// triangulation of simple polygons", 1983). Of triangles that coincide one is kept.
std::vector<Polygon> convex_faces(const Mesh& mesh);

/// The part of a convex polygon between two heights; empty if there is none.
Polygon between(const Polygon& polygon, double low_z, double high_z);

/// The part of a segment between two heights; both ends equal if there is none.
Segment between(const Segment& segment, double low_z, double high_z);

}  // namespace vernier::sim::internal
