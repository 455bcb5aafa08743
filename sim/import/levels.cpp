// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/import/levels.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "sim/import/mesh.h"

namespace vernier::sim::internal {

namespace {

constexpr double outer = 0.1;          // of the extent
constexpr double at_level_m = 6e-3;    // of a mesh 10 m large: 3 cm in a building of 50 m
constexpr double same_plane = 0.9999;  // cosine between the normals of two faces in a plane

using Edge = std::pair<std::uint32_t, std::uint32_t>;
using Corners = std::array<Eigen::Vector3d, 3>;

Eigen::Vector3d normal_of(const Corners& corners) {
  return (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
}

/// Length of the line in which a triangle cuts a level.
double cut_length(const Corners& corners, int axis, double height) {
  std::vector<Eigen::Vector3d> ends;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d &a = corners[k], &b = corners[(k + 1) % 3];
    const double above_a = a[axis] - height, above_b = b[axis] - height;
    if ((above_a < 0) == (above_b < 0)) continue;
    ends.push_back(a + above_a / (above_a - above_b) * (b - a));
  }
  return ends.size() == 2 ? (ends[0] - ends[1]).norm() : 0;
}

}  // namespace

std::vector<Level> levels_of(const Mesh& mesh, int axis, double least_area) {
  constexpr std::size_t slices = 2000;
  const auto [low, high] = extent_of(mesh);
  const double slice = std::max(high[axis] - low[axis], 1e-300) / slices;
  std::array<double, slices + 1> area{}, moment{};
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    const Eigen::Vector3d twice = (q - p).cross(r - p);
    if (!(std::abs(twice[axis]) > floor_cosine * twice.norm())) continue;
    const double height = (p[axis] + q[axis] + r[axis]) / 3;
    const double at = std::clamp((height - low[axis]) / slice, 0.0, static_cast<double>(slices));
    area[static_cast<std::size_t>(at)] += 0.5 * std::abs(twice[axis]);
    moment[static_cast<std::size_t>(at)] += 0.5 * std::abs(twice[axis]) * height;
  }
  std::vector<Level> levels;
  for (std::size_t i = 0; i <= slices; ++i) {
    double all = 0, sum = 0;
    for (; i <= slices && area[i] > 0; ++i) {
      all += area[i];
      sum += moment[i];
    }
    if (all >= least_area && all > 0) levels.push_back({sum / all, all});
  }
  return levels;
}

namespace {

/// Heights of the levels within a building.
std::vector<double> inner_heights(const Mesh& mesh, int axis) {
  const auto [low, high] = extent_of(mesh);
  const Eigen::Vector3d size = high - low;
  std::vector<double> heights;
  for (const Level& level :
       levels_of(mesh, axis, least_of_plan * size[(axis + 1) % 3] * size[(axis + 2) % 3])) {
    const double from_end = std::min(level.height - low[axis], high[axis] - level.height);
    if (from_end >= outer * size[axis]) heights.push_back(level.height);
  }
  return heights;
}

Corners corners_of(const Mesh& mesh, const std::array<std::uint32_t, 3>& t) {
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

double length_of(const Mesh& mesh, const Edge& edge) {
  return (mesh.vertices[edge.first] - mesh.vertices[edge.second]).norm();
}

/// Whether faces are one surface, which has no edge between them.
bool are_one_surface(const std::vector<Eigen::Vector3d>& normals) {
  return normals.size() == 2 && std::abs(normals[0].dot(normals[1])) > same_plane;
}

/// Whether an upright surface that has an edge in a level goes on beyond it, and nothing else meets
/// it there; nothing if no upright surface has it.
std::optional<bool> passes(const std::vector<Eigen::Vector3d>& normals, int axis) {
  const auto is_upright = [&](const Eigen::Vector3d& n) { return std::abs(n[axis]) < wall_cosine; };
  if (std::none_of(normals.begin(), normals.end(), is_upright)) return {};
  return are_one_surface(normals);
}

/// Share of the cross-section of upright surfaces at these heights that ends there.
double ending_share(const Mesh& mesh,
                    const Triangles& triangles,
                    int axis,
                    const std::vector<double>& heights) {
  double passing = 0, ending = 0;
  std::map<Edge, std::vector<Eigen::Vector3d>> normals;  // of the faces at edges in a level
  for (const auto& t : triangles) {
    const Corners corners = corners_of(mesh, t);
    const Eigen::Vector3d normal = normal_of(corners);
    const auto [least, most] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
    auto level = std::lower_bound(heights.begin(), heights.end(), least - at_level_m);
    for (; level != heights.end() && *level <= most + at_level_m; ++level) {
      const auto is_at = [&](int k) { return std::abs(corners[k][axis] - *level) < at_level_m; };
      for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        if (is_at(k) && is_at(next)) normals[std::minmax(t[k], t[next])].push_back(normal);
      }
      const bool is_upright = std::abs(normal[axis]) < wall_cosine;
      if (is_upright && least < *level - at_level_m && most > *level + at_level_m) {
        passing += cut_length(corners, axis, *level);
      }
    }
  }
  for (const auto& [edge, at] : normals) {
    const std::optional<bool> does_pass = passes(at, axis);
    if (!does_pass) continue;
    (*does_pass ? passing : ending) += length_of(mesh, edge);
  }
  return ending + passing > 0 ? ending / (ending + passing) : 0;
}

}  // namespace

Triangles different_triangles(const Mesh& mesh) {
  Triangles triangles = mesh.triangles;
  for (auto& t : triangles) std::sort(t.begin(), t.end());
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  return triangles;
}

std::optional<InnerFloors> inner_floors(const Mesh& mesh, const Triangles& triangles, int axis) {
  if (mesh.triangles.empty()) return {};
  const std::vector<double> heights = inner_heights(mesh, axis);
  if (heights.empty()) return {};
  const auto [low, high] = extent_of(mesh);
  InnerFloors found{ending_share(mesh, triangles, axis, heights), high[axis] - heights.back()};
  double below = low[axis];
  for (const double height : heights) {
    found.highest = std::max(found.highest, height - below);
    below = height;
  }
  return found;
}

namespace {

/// Whether level surface lies around all that is higher than a fence if this axis is up.
bool has_ground(const Mesh& mesh, const Triangles& triangles, int axis) {
  constexpr double beyond = 1.2;         // times what stands on it
  constexpr double least_rim = 0.02;     // of that, on every side: a wing of an L has none
  constexpr double thickest = 0.02;      // of the whole: it may be a slab
  constexpr double thickest_up = 0.1;    // of the height
  constexpr double least_share = 0.5;    // of its bounding box
  constexpr double highest_fence = 0.6;  // of the height
  const auto [low, high] = extent_of(mesh);
  const double height = high[axis] - low[axis];
  const double top = low[axis] + std::min(thickest * (high - low).norm(), thickest_up * height);
  const double fence = low[axis] + highest_fence * height;
  Eigen::AlignedBox3d ground, rest;
  double twice_area = 0;  // of both faces, if it is a slab
  for (const auto& t : triangles) {
    const Corners corners = corners_of(mesh, t);
    const double most = std::max({corners[0][axis], corners[1][axis], corners[2][axis]});
    const bool is_level = std::abs(normal_of(corners)[axis]) > floor_cosine;
    if (is_level && most <= top) {
      twice_area += std::abs((corners[1] - corners[0]).cross(corners[2] - corners[0])[axis]);
      for (const Eigen::Vector3d& corner : corners) ground.extend(corner);
    } else if (most > fence) {
      for (const Eigen::Vector3d& corner : corners) rest.extend(corner);
    }
  }
  if (ground.isEmpty() || rest.isEmpty()) return false;
  const int one = (axis + 1) % 3, other = (axis + 2) % 3;
  const auto reaches_beyond = [&](int along) {
    const double length = rest.sizes()[along];
    return ground.sizes()[along] >= beyond * length &&
           ground.min()[along] <= rest.min()[along] - least_rim * length &&
           ground.max()[along] >= rest.max()[along] + least_rim * length;
  };
  const double box = ground.sizes()[one] * ground.sizes()[other];
  return reaches_beyond(one) && reaches_beyond(other) && 0.5 * twice_area >= least_share * box;
}

}  // namespace

std::optional<int> axis_of_ground(const Mesh& mesh, const Triangles& triangles) {
  std::optional<int> found;
  for (int axis = 0; axis < 3; ++axis) {
    if (!has_ground(mesh, triangles, axis)) continue;
    if (found) return {};
    found = axis;
  }
  return found;
}

bool is_of_sheets(const Mesh& mesh, const Triangles& triangles) {
  constexpr double few = 0.1;  // of the length of edges
  std::map<Edge, std::vector<Eigen::Vector3d>> normals;
  for (const auto& t : triangles) {
    const Eigen::Vector3d normal = normal_of(corners_of(mesh, t));
    for (int k = 0; k < 3; ++k) normals[std::minmax(t[k], t[(k + 1) % 3])].push_back(normal);
  }
  double all = 0, odd = 0;
  for (const auto& [edge, at] : normals) {
    if (are_one_surface(at)) continue;
    all += length_of(mesh, edge);
    if (at.size() % 2 == 1) odd += length_of(mesh, edge);
  }
  return odd > few * all;
}

}  // namespace vernier::sim::internal
