// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/import/mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "sim/import/point_grid.h"

namespace vernier::sim::internal {

namespace {

double height(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const double base = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  return base > 0 ? (b - a).cross(c - a).norm() / base : 0;
}

}  // namespace

MeshExtent extent_of(const Mesh& mesh) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  MeshExtent extent{Eigen::Vector3d::Constant(infinity), Eigen::Vector3d::Constant(-infinity)};
  for (const Eigen::Vector3d& v : mesh.vertices) {
    extent.low = extent.low.cwiseMin(v);
    extent.high = extent.high.cwiseMax(v);
  }
  return extent;
}

Mesh with_used_vertices(Mesh mesh) {
  std::vector<char> is_used(mesh.vertices.size());
  const auto each_end = [&](const auto& visit) {
    for (auto& triangle : mesh.triangles) std::for_each(triangle.begin(), triangle.end(), visit);
    for (auto& line : mesh.lines) std::for_each(line.begin(), line.end(), visit);
  };
  each_end([&](std::uint32_t& i) { is_used[i] = 1; });
  std::vector<std::uint32_t> moved(mesh.vertices.size());
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (!is_used[i]) continue;
    mesh.vertices[kept] = mesh.vertices[i];
    moved[i] = kept++;
  }
  mesh.vertices.resize(kept);
  each_end([&](std::uint32_t& i) { i = moved[i]; });
  return mesh;
}

Mesh welded(const Mesh& mesh, double within) {
  Mesh result;
  result.up_axis = mesh.up_axis;
  result.unit_m = mesh.unit_m;
  result.up_because = mesh.up_because;
  result.unit_because = mesh.unit_because;
  result.format = mesh.format;
  std::vector<std::uint32_t> moved(mesh.vertices.size());
  PointGrid grid(within);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3d& at = mesh.vertices[i];
    constexpr auto none = std::numeric_limits<std::uint32_t>::max();
    std::uint32_t same = none;
    grid.visit_near(at, [&](std::uint32_t other) {
      if ((result.vertices[other] - at).norm() < within) same = std::min(same, other);
    });
    if (same == none) {
      same = static_cast<std::uint32_t>(result.vertices.size());
      result.vertices.push_back(at);
      grid.add(at, same);
    }
    moved[i] = same;
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::array<std::uint32_t, 3> t{moved[a], moved[b], moved[c]};
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    if (height(result.vertices[t[0]], result.vertices[t[1]], result.vertices[t[2]]) < within) {
      continue;
    }
    result.triangles.push_back(t);
  }
  for (const auto& [a, b] : mesh.lines) {
    if (moved[a] != moved[b]) result.lines.push_back({moved[a], moved[b]});
  }
  return result;
}

}  // namespace vernier::sim::internal
