// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sim/world.h"

namespace vernier::sim::internal {

/// A world as the text of a Wavefront OBJ file: segments as lines (l), surfaces as faces (f), in
/// metres, z up.
std::string world_obj(const World& world);

/// The same as a PLY file in ASCII: segments as edges, surfaces as faces.
std::string world_ply(const World& world);

}  // namespace vernier::sim::internal
