// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/import/mesh.h"

namespace vernier::sim::internal {

/// Reads a mesh or lines by the ending of the file's name: PLY with faces and edges, lists of lines
/// (.txt: x1 y1 z1 x2 y2 z2 in a line, metres, z up), and what assimp reads, among them OBJ, DAE,
/// IFC, glTF, FBX, STL. Of formats whose parts have names, those with one of the words in theirs or
/// in that of what they belong to are left out (in small letters and capitals alike), as doors
/// that stand closed. Throws Error naming the file, and where it can the line; for words given with
/// a file whose parts have no names.
Mesh read_mesh(const std::filesystem::path& file, const std::vector<std::string>& leave_out = {});

/// Letters of ASCII in small ones.
std::string in_small_letters(std::string text);

/// A list of lines, and a PLY file.
Mesh read_line_list(const std::filesystem::path& file);
Mesh read_ply(const std::filesystem::path& file);

/// A file through assimp; where Vernier was built without it, throws Error that says so.
Mesh read_with_assimp(const std::filesystem::path& file, const std::vector<std::string>& leave_out);

/// assimp's version; empty without it.
std::string assimp_version();

}  // namespace vernier::sim::internal
