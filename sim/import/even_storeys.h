// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "sim/import/mesh.h"

namespace vernier::sim::internal {

/// Storeys of one height above each other along an axis, in units of the mesh.
struct EvenStoreys {
  double first = 0;   ///< where the first of them begins
  double height = 0;  ///< of each, from floor to floor
  int count = 0;      ///< at least 2
};

/// The storeys of which a mesh may consist if `axis` is up: surfaces level with respect to it, each
/// over at least a third of the plan, at even heights (to 2 % of a storey). Above two levels
/// lies a storey like the lower; of more, less than two heights of a storey may be left below and
/// above (3.5 above four levels and more: a roof), and none half way between two of them. Of
/// several such rows that with most surface. None in a mesh without triangles, and in one more than
/// three times as high as its plan is wide (4.5 times with five storeys, 8 with six and more):
/// walls at even distances in a row of rooms are no floors of a tower.
std::optional<EvenStoreys> even_storeys(const Mesh& mesh, int axis);

}  // namespace vernier::sim::internal
