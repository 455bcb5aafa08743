// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace vernier::sim::internal {

/// Triangles and lines as a file gives them: before import, in its units and axes.
struct Mesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::array<std::uint32_t, 2>> lines;
  /// What the file says of its axes and units; nothing where it does not.
  std::optional<int> up_axis;  ///< 0 to 2: +x, +y, +z
  std::optional<double> unit_m;
  std::string up_because = "by the file", unit_because = "by the file";  ///< why so
  std::string format;
  double step = 0;  ///< to which coordinates were rounded, in units of the file
  std::size_t parts_left_out = 0, doors = 0;  ///< of its parts; doors that IFC names and that stay
};

/// Largest mesh that is imported.
inline constexpr std::size_t most_triangles = 3'000'000;

/// The corners of a mesh's bounding box; an infinite one the wrong way round without vertices.
struct MeshExtent {
  Eigen::Vector3d low, high;
};
MeshExtent extent_of(const Mesh& mesh);

/// The same mesh without the vertices that no triangle and no line has.
Mesh with_used_vertices(Mesh mesh);

/// The same mesh with vertices closer than `within` made one, each the first of them. Triangles and
/// lines that lose an end, and triangles lower than `within`, are left out.
Mesh welded(const Mesh& mesh, double within);

using Segment = std::pair<Eigen::Vector3d, Eigen::Vector3d>;
using Polygon = std::vector<Eigen::Vector3d>;

}  // namespace vernier::sim::internal
