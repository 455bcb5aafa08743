// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/import/mesh.h"

namespace vernier::sim::internal {

/// A height along an axis at which surface is level with respect to it, and how much.
struct Level {
  double height, area;
};

inline constexpr double floor_cosine = 0.98;  ///< a surface is level from this on
inline constexpr double wall_cosine = 0.2;    ///< and upright below this
inline constexpr double least_of_plan =
    0.33;  ///< of the plan's bounding box: a floor, also of an L

/// Heights at which so much surface is level, ascending: one for each run of slices (1/2000 of the
/// extent) that hold any.
std::vector<Level> levels_of(const Mesh& mesh, int axis, double least_area);

/// What upright surfaces do at the floors within a building if an axis is up.
struct InnerFloors {
  double ending = 0;   ///< share of their cross-section there that ends, and does not pass through
  double highest = 0;  ///< the largest distance between neighbours, and the ends of the building
};

/// The triangles of a mesh, those that it has twice once, each with its vertices ascending.
using Triangles = std::vector<std::array<std::uint32_t, 3>>;
Triangles different_triangles(const Mesh& mesh);

/// The levels over at least a third of the plan, without those in the outer tenths of the extent,
/// where façades and thick slabs have theirs; nothing without any. Floors interrupt walls, and
/// walls do not interrupt floors: so where walls are taken for floors, the true floors pass through
/// them. An upright surface ends at an edge at which it does not go on in its plane, or at which
/// another surface meets it. For a welded mesh about 10 m large, and its different triangles.
std::optional<InnerFloors> inner_floors(const Mesh& mesh, const Triangles& triangles, int axis);

/// The one axis at whose lower end level surface lies that reaches beyond all else but fences, by a
/// fifth of its length and of its width, and by a fiftieth on every side: the ground around a
/// building. Nothing without any, and where two axes have one.
std::optional<int> axis_of_ground(const Mesh& mesh, const Triangles& triangles);

/// Whether a welded mesh has surfaces without thickness: an edge of a solid has two faces, or four
/// where two solids meet, and one of a sheet often one or three.
bool is_of_sheets(const Mesh& mesh, const Triangles& triangles);

}  // namespace vernier::sim::internal
