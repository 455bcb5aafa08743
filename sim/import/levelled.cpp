// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/import/levelled.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "sim/import/mesh.h"

namespace vernier::sim::internal {

using Eigen::Vector3d;

namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double least_rad = 0.02 * degree;  // 7 mm in 20 m
constexpr double most_rad = 5 * degree;
constexpr double least_level_share = 0.5;

/// Unit normals, upwards if they are roughly so, with areas.
struct Faces {
  std::vector<std::pair<Vector3d, double>> level, walls;
};

Faces faces_of(const Mesh& mesh) {
  Faces faces;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3d& p = mesh.vertices[a];
    const Vector3d twice = (mesh.vertices[b] - p).cross(mesh.vertices[c] - p);
    const double area = 0.5 * twice.norm();
    if (!(area > 0)) continue;
    const Vector3d normal = twice.normalized() * (twice.z() < 0 ? -1 : 1);
    if (normal.z() > std::cos(most_rad)) faces.level.emplace_back(normal, area);
    if (normal.z() < std::sin(most_rad)) faces.walls.emplace_back(normal, area);
  }
  return faces;
}

/// Share of level faces whose normals lie within an angle of `up`.
double level_share(const Faces& faces, const Vector3d& up, double within_rad) {
  double all = 0, near = 0;
  for (const auto& [normal, area] : faces.level) {
    all += area;
    if (normal.cross(up).norm() < std::sin(within_rad)) near += area;
  }
  return all > 0 ? near / all : 0;
}

/// Share of walls that stand upright to `up` within an angle.
double wall_share(const Faces& faces, const Vector3d& up, double within_rad) {
  double all = 0, near = 0;
  for (const auto& [normal, area] : faces.walls) {
    all += area;
    if (std::abs(normal.dot(up)) < std::sin(within_rad)) near += area;
  }
  return all > 0 ? near / all : 0;
}

/// Mean normal of the level faces, again and again of those nearer to the last mean.
Vector3d commonest_level(const Faces& faces) {
  Vector3d up = Vector3d::UnitZ();
  for (const double within_deg : {6.0, 2.0, 0.7, 0.25}) {
    Vector3d sum = Vector3d::Zero();
    for (const auto& [normal, area] : faces.level) {
      if (normal.cross(up).norm() < std::sin(within_deg * degree)) sum += area * normal;
    }
    if (sum.isZero()) break;
    up = sum.normalized();
  }
  return up;
}

}  // namespace

std::optional<Vector3d> leaning_up(const Mesh& mesh) {
  const Faces faces = faces_of(mesh);
  const Vector3d z = Vector3d::UnitZ();
  if (faces.level.empty() || faces.walls.empty()) return {};
  if (level_share(faces, z, least_rad) >= least_level_share) return {};
  const Vector3d up = commonest_level(faces);
  const double lean = std::asin(std::min(1.0, up.cross(z).norm()));
  if (!(lean >= least_rad && lean <= most_rad)) return {};
  const double within = std::min(0.25 * degree, lean / 4);
  if (level_share(faces, up, within) < least_level_share) return {};
  // Walls along the axis of the lean stand upright to both; the others must lean too.
  const double walls = wall_share(faces, up, within);
  constexpr double clearly = 1.02;
  if (walls < least_level_share || walls < clearly * wall_share(faces, z, within)) return {};
  return up;
}

Mesh levelled(Mesh mesh, const Vector3d& up) {
  const auto [low, high] = extent_of(mesh);
  const Vector3d middle = 0.5 * (low + high);
  const Eigen::Matrix3d R =
      Eigen::Quaterniond::FromTwoVectors(up, Vector3d::UnitZ()).toRotationMatrix();
  for (Vector3d& v : mesh.vertices) v = middle + R * (v - middle);
  return mesh;
}

double floor_slope_rad(const Mesh& mesh, double floor_m) {
  constexpr double near_m = 0.1, least_slope_rad = 0.2 * degree;
  Mesh at_floor = mesh;
  std::erase_if(at_floor.triangles, [&](const auto& corners) {
    const auto [low, high] =
        std::minmax({mesh.vertices[corners[0]].z(), mesh.vertices[corners[1]].z(),
                     mesh.vertices[corners[2]].z()});
    return low > floor_m + near_m || high < floor_m - near_m;
  });
  std::vector<std::pair<double, double>> leans;  // with areas
  double left = 0;
  for (const auto& [normal, area] : faces_of(at_floor).level) {
    leans.emplace_back(lean_rad(Vector3d::Zero(), normal), area);
    left += 0.5 * area;
  }
  std::sort(leans.begin(), leans.end());
  for (const auto& [lean, area] : leans) {
    left -= area;
    if (left <= 0) return lean >= least_slope_rad ? lean : 0;
  }
  return 0;
}

double lean_rad(const Vector3d& a, const Vector3d& b) {
  const Vector3d d = b - a;
  return std::atan2(d.head<2>().norm(), std::abs(d.z()));
}

void make_upright(Vector3d& a_m, Vector3d& b_m) {
  const Eigen::Vector2d middle = 0.5 * (a_m + b_m).head<2>();
  a_m.head<2>() = b_m.head<2>() = middle;
}

}  // namespace vernier::sim::internal
