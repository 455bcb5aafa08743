// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/import/convex_faces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "sim/import/mesh.h"

namespace vernier::sim::internal {

namespace {

using Vertex = std::uint32_t;
using Face = std::vector<Vertex>;

constexpr double planar_m = 5e-4, bend_m = 1e-6;

Eigen::Vector3d normal_of(const Mesh& mesh, const Face& face) {
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  const Eigen::Vector3d& first = mesh.vertices[face[0]];
  for (std::size_t i = 1; i + 1 < face.size(); ++i) {
    area += (mesh.vertices[face[i]] - first).cross(mesh.vertices[face[i + 1]] - first);
  }
  return area.normalized();
}

bool is_planar(const Mesh& mesh, const Face& face, const Eigen::Vector3d& normal) {
  const Eigen::Vector3d& first = mesh.vertices[face[0]];
  return std::all_of(face.begin(), face.end(), [&](Vertex v) {
    return std::abs(normal.dot(mesh.vertices[v] - first)) < planar_m;
  });
}

bool is_convex(const Mesh& mesh, const Face& face, const Eigen::Vector3d& normal) {
  double turned = 0;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const Eigen::Vector3d& a = mesh.vertices[face[i]];
    const Eigen::Vector3d& b = mesh.vertices[face[(i + 1) % face.size()]];
    const Eigen::Vector3d& c = mesh.vertices[face[(i + 2) % face.size()]];
    const Eigen::Vector3d d = (b - a).normalized(), e = (c - b).normalized();
    const double turn = std::atan2(normal.dot(d.cross(e)), d.dot(e));
    if (turn < -1e-6) return false;
    turned += turn;
  }
  return turned < 6.5;  // once around, 2 π
}

/// Two faces along a common edge and what continues it as one, which runs around as the first does.
std::optional<Face> joined(const Face& one, Face other, Vertex a, Vertex b) {
  const auto edge_at = [&](const Face& face, Vertex from, Vertex to) -> std::size_t {
    for (std::size_t i = 0; i < face.size(); ++i) {
      if (face[i] == from && face[(i + 1) % face.size()] == to) return i;
    }
    return face.size();
  };
  std::size_t i = edge_at(one, a, b);
  if (i == one.size()) {
    std::swap(a, b);
    i = edge_at(one, a, b);
  }
  std::size_t k = edge_at(other, b, a);
  if (k == other.size()) {  // it runs around the other way
    std::reverse(other.begin(), other.end());
    k = edge_at(other, b, a);
  }
  if (i == one.size() || k == other.size()) return {};
  // They may have more edges in common on either side of it.
  const std::size_t n1 = one.size(), n2 = other.size();
  const auto of_one = [&](std::size_t n) { return one[(i + n) % n1]; };
  const auto of_other = [&](std::size_t n) { return other[(k + n) % n2]; };
  std::size_t ahead = 0, behind = 0;
  while (ahead + 3 < std::min(n1, n2) && of_one(2 + ahead) == of_other(n2 - 1 - ahead)) ++ahead;
  while (ahead + behind + 3 < std::min(n1, n2) && of_one(n1 - 1 - behind) == of_other(2 + behind)) {
    ++behind;
  }
  Face face;
  for (std::size_t n = 1 + ahead; n <= n1 - behind; ++n) face.push_back(of_one(n));
  for (std::size_t n = 2 + behind; n < n2 - ahead; ++n) face.push_back(of_other(n));
  if (std::set<Vertex>(face.begin(), face.end()).size() != face.size()) return {};
  return face;
}

}  // namespace

std::vector<Polygon> convex_faces(const Mesh& mesh) {
  constexpr std::size_t most_corners = 400;
  std::vector<Face> faces;
  std::set<std::array<Vertex, 3>> known;
  for (auto t : mesh.triangles) {
    std::array<Vertex, 3> sorted = t;
    std::sort(sorted.begin(), sorted.end());
    if (known.insert(sorted).second) faces.push_back({t[0], t[1], t[2]});
  }
  std::vector<std::size_t> owner(faces.size());
  std::map<std::pair<Vertex, Vertex>, std::vector<std::size_t>> sides;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    owner[i] = i;
    for (int k = 0; k < 3; ++k) sides[std::minmax(faces[i][k], faces[i][(k + 1) % 3])].push_back(i);
  }
  const auto now = [&](std::size_t face) {
    while (owner[face] != face) face = owner[face];
    return face;
  };
  std::vector<std::tuple<double, Vertex, Vertex>> longest_first;
  for (const auto& [edge, on] : sides) {
    if (on.size() < 2) continue;
    const double length = (mesh.vertices[edge.first] - mesh.vertices[edge.second]).norm();
    longest_first.emplace_back(-length, edge.first, edge.second);
  }
  std::sort(longest_first.begin(), longest_first.end());
  for (const auto& [length, a, b] : longest_first) {
    const std::vector<std::size_t>& on = sides[{a, b}];
    for (std::size_t m = 0; m < on.size(); ++m) {
      for (std::size_t n = m + 1; n < on.size(); ++n) {
        const std::size_t one = now(on[m]), other = now(on[n]);
        if (one == other || faces[one].size() + faces[other].size() > most_corners) continue;
        const Eigen::Vector3d normal = normal_of(mesh, faces[one]);
        if (std::abs(normal.dot(normal_of(mesh, faces[other]))) < 0.9999) continue;
        const std::optional<Face> both = joined(faces[one], faces[other], a, b);
        if (!both || !is_planar(mesh, *both, normal) || !is_convex(mesh, *both, normal)) continue;
        faces[one] = *both;
        faces[other].clear();
        owner[other] = one;
      }
    }
  }
  std::vector<Polygon> polygons;
  for (const Face& face : faces) {
    if (face.empty()) continue;
    Polygon polygon;
    for (std::size_t i = 0; i < face.size(); ++i) {
      const Eigen::Vector3d& before = mesh.vertices[face[(i + face.size() - 1) % face.size()]];
      const Eigen::Vector3d &here = mesh.vertices[face[i]],
                            &next = mesh.vertices[face[(i + 1) % face.size()]];
      const Eigen::Vector3d d = (here - before).normalized();
      if (d.cross(next - here).norm() > bend_m) polygon.push_back(here);
    }
    if (polygon.size() >= 3) polygons.push_back(std::move(polygon));
  }
  return polygons;
}

Polygon between(const Polygon& polygon, double low_z, double high_z) {
  Polygon rest = polygon;
  for (const auto& [side, limit] : {std::pair(1.0, low_z), {-1.0, high_z}}) {
    Polygon cut;
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const Eigen::Vector3d &a = rest[i], &b = rest[(i + 1) % rest.size()];
      const double above_a = side * (a.z() - limit), above_b = side * (b.z() - limit);
      if (above_a >= 0) cut.push_back(a);
      if ((above_a > 0 && above_b < 0) || (above_a < 0 && above_b > 0)) {
        Eigen::Vector3d at = a + above_a / (above_a - above_b) * (b - a);
        at.z() = limit;
        cut.push_back(at);
      }
    }
    rest = std::move(cut);
  }
  return rest.size() < 3 ? Polygon{} : rest;
}

Segment between(const Segment& segment, double low_z, double high_z) {
  Segment rest = segment;
  for (const auto& [side, limit] : {std::pair(1.0, low_z), {-1.0, high_z}}) {
    auto& [a, b] = rest;
    const double above_a = side * (a.z() - limit), above_b = side * (b.z() - limit);
    if (above_a < 0 && above_b < 0) return {a, a};
    if (above_a >= 0 && above_b >= 0) continue;
    Eigen::Vector3d at = a + above_a / (above_a - above_b) * (b - a);
    at.z() = limit;
    (above_a < 0 ? a : b) = at;
  }
  return rest;
}

}  // namespace vernier::sim::internal
