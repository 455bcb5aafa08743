// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sim/import/mesh.h"

namespace vernier::sim::internal {

/// What a reader in a child process has found of a mesh, as bytes of this machine: its vertices,
/// triangles, lines, up_axis, unit_m, parts_left_out and doors.
std::string mesh_bytes(const Mesh& mesh);

/// Reads them back. Throws Error(place) for bytes of no mesh: a library that has damaged its memory
/// and did not crash may have made them.
Mesh mesh_of_bytes(const std::string& bytes, const std::string& place);

}  // namespace vernier::sim::internal
