// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/import/mesh.h"

namespace vernier::sim::internal {

/// What is left out of a file.
struct MeshSelection {
  /// Of formats whose parts have names, those with one of these words in theirs or in that of what
  /// they belong to (in small letters and capitals alike), as doors that stand closed.
  std::vector<std::string> leave_out;
  int least_images = 0;  ///< line tracks that fewer images support
};

/// Reads a mesh or lines by the ending of the file's name: PLY with faces and edges, lists of lines
/// (.txt: x1 y1 z1 x2 y2 z2 in a line, metres, z up), line tracks of LIMAP (.txt, or a folder), and
/// what assimp reads, among them OBJ, DAE, IFC, glTF, FBX, STL. Throws Error naming the file, and
/// where it can the line; for a selection that such a file does not allow.
Mesh read_mesh(const std::filesystem::path& file, const MeshSelection& selection = {});

/// Line tracks of LIMAP that at least so many images support, in no unit and with no axis: one file
/// of all, or a folder of a file track_N.txt each. Whether a text file holds such tracks: its first
/// line is a number alone.
Mesh read_line_tracks(const std::filesystem::path& path, int least_images = 0);
bool holds_line_tracks(const std::filesystem::path& file);

/// A list of lines, and a PLY file.
Mesh read_line_list(const std::filesystem::path& file);
Mesh read_ply(const std::filesystem::path& file);

/// A file through assimp; where Vernier was built without it, throws Error that says so.
Mesh read_with_assimp(const std::filesystem::path& file, const std::vector<std::string>& leave_out);

/// assimp's version; empty without it.
std::string assimp_version();

}  // namespace vernier::sim::internal
