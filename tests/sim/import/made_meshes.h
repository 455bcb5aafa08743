// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sim/import/mesh.h"

namespace vernier::test {

using sim::internal::Mesh;

/// Adds a rectangle that faces along u x v, in nu x nv pieces of two triangles each, whose vertices
/// are its own.
inline void add_rectangle(Mesh& mesh,
                          const Eigen::Vector3d& corner,
                          const Eigen::Vector3d& u,
                          const Eigen::Vector3d& v,
                          int nu = 1,
                          int nv = 1) {
  for (int i = 0; i < nu; ++i) {
    for (int k = 0; k < nv; ++k) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      const Eigen::Vector3d at = corner + u * i / nu + v * k / nv;
      for (const Eigen::Vector3d& p :
           {at, Eigen::Vector3d(at + u / nu), Eigen::Vector3d(at + u / nu + v / nv),
            Eigen::Vector3d(at + v / nv)}) {
        mesh.vertices.push_back(p);
      }
      mesh.triangles.push_back({first, first + 1, first + 2});
      mesh.triangles.push_back({first, first + 2, first + 3});
    }
  }
}

/// Adds a box whose faces look outwards.
inline void add_box(Mesh& mesh,
                    const Eigen::Vector3d& low,
                    const Eigen::Vector3d& high,
                    int pieces = 1) {
  const Eigen::Vector3d s = high - low;
  const Eigen::Vector3d x(s.x(), 0, 0), y(0, s.y(), 0), z(0, 0, s.z());
  add_rectangle(mesh, low, y, x, pieces, pieces);
  add_rectangle(mesh, low + z, x, y, pieces, pieces);
  add_rectangle(mesh, low, x, z, pieces, pieces);
  add_rectangle(mesh, low + y, z, x, pieces, pieces);
  add_rectangle(mesh, low, z, y, pieces, pieces);
  add_rectangle(mesh, low + x, y, z, pieces, pieces);
}

/// A house of two rooms of 4 x 3 m with walls 0.1 m thick, a door of 1 m in the wall between them
/// and one of 0.9 m outside, z up, in metres.
inline Mesh house(double floor_z = 0, bool with_floor = true) {
  Mesh mesh;
  const double h = floor_z + 2.5;
  const auto wall = [&](double x0, double y0, double x1, double y1) {
    add_box(mesh, {x0, y0, floor_z}, {x1, y1, h});
  };
  wall(-0.1, -0.1, 8.2, 0);
  wall(-0.1, 3, 8.2, 3.1);
  wall(-0.1, 0, 0, 3);
  wall(8.1, 0, 8.2, 1);
  wall(8.1, 1.9, 8.2, 3);
  wall(4, 0, 4.1, 1);
  wall(4, 2, 4.1, 3);
  if (with_floor) add_rectangle(mesh, {-0.1, -0.1, floor_z}, {8.3, 0, 0}, {0, 3.2, 0});
  return mesh;
}

/// Two storeys of the house and their slabs.
inline Mesh two_storeys() {
  Mesh mesh = house();
  const Mesh upper = house(3, false);
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), upper.vertices.begin(), upper.vertices.end());
  for (const auto& [a, b, c] : upper.triangles) {
    mesh.triangles.push_back({first + a, first + b, first + c});
  }
  add_box(mesh, {-0.1, -0.1, 2.7}, {8.2, 3.1, 3});
  return mesh;
}

/// As a file holds it with this axis up and this unit.
inline Mesh turned_and_scaled(Mesh mesh, int up, double unit_m) {
  for (Eigen::Vector3d& v : mesh.vertices) {
    if (up == 1) v = Eigen::Vector3d(v.x(), v.z(), -v.y());
    if (up == 0) v = Eigen::Vector3d(v.z(), v.y(), -v.x());
    v /= unit_m;
  }
  return mesh;
}

}  // namespace vernier::test
