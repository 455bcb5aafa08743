// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/import/storeys.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "sim/import/mesh.h"

namespace vernier::sim::internal {

namespace {

constexpr double level_m = 0.05;  // heights are told apart to this
constexpr double lowest_storey_m = 2.2, lowest_wall_m = 1.5;
constexpr double least_walls = 0.2;  // length at their lower ends, of that of the storey with most
constexpr double least_floor = 0.1;  // level surface that faces up, of the plan's bounding box
constexpr double floor_below_m = 0.1, floor_above_m = 0.4;  // of where walls begin

double plan_area(const Mesh& mesh) {
  if (mesh.vertices.empty()) return 0;
  Eigen::Vector3d low = mesh.vertices[0], high = low;
  for (const Eigen::Vector3d& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  return (high.x() - low.x()) * (high.y() - low.y());
}

}  // namespace

std::vector<double> floor_heights_m(const Mesh& mesh) {
  struct Level {
    double amount = 0, moment = 0;
    void add(double much, double z) {
      amount += much;
      moment += much * z;
    }
    double z() const { return moment / amount; }
  };
  std::map<long, Level> floors, walls;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    const Eigen::Vector3d twice = (q - p).cross(r - p);
    const double area = 0.5 * twice.norm();
    if (!(area > 0)) continue;
    const double up = 0.5 * twice.z() / area;
    const auto [low, high] = std::minmax({p.z(), q.z(), r.z()});
    if (up > 0.98) {
      const double z = (p.z() + q.z() + r.z()) / 3;
      floors[std::lround(z / level_m)].add(area, z);
    } else if (std::abs(up) < 0.2 && high - low >= lowest_wall_m) {
      walls[std::lround(low / level_m)].add(area / (high - low), low);
    }
  }
  const auto most = [](const std::map<long, Level>& levels) {
    double amount = 0;
    for (const auto& [index, level] : levels) amount = std::max(amount, level.amount);
    return amount;
  };
  const double most_walls = most(walls), plan = plan_area(mesh);
  std::vector<double> heights;
  for (const auto& [index, wall] : walls) {
    if (wall.amount < least_walls * most_walls) continue;
    if (!heights.empty() && wall.z() < heights.back() + lowest_storey_m) continue;
    double height = wall.z(), largest = least_floor * plan;
    for (const auto& [level, floor] : floors) {
      const double above = floor.z() - wall.z();
      if (above < -floor_below_m || above > floor_above_m || floor.amount < largest) continue;
      largest = floor.amount;
      height = floor.z();
    }
    heights.push_back(height);
  }
  return heights;
}

}  // namespace vernier::sim::internal
