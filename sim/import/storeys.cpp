// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/import/storeys.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>

#include "sim/import/mesh.h"

namespace vernier::sim::internal {

namespace {

constexpr double level_m = 0.05;  // heights are told apart to this
constexpr double lowest_wall_m = 1.5;
constexpr double least_walls = 0.2;  // length at their lower ends, of that of the storey with most
constexpr double least_floor = 0.1;  // level surface that faces up, of the plan's bounding box
constexpr double floor_below_m = 0.1, floor_above_m = 0.4;  // of where walls begin

double plan_area(const std::vector<Polygon>& faces) {
  if (faces.empty()) return 0;
  Eigen::Vector3d low = faces[0][0], high = low;
  for (const Polygon& face : faces) {
    for (const Eigen::Vector3d& v : face) {
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
  }
  return (high.x() - low.x()) * (high.y() - low.y());
}

}  // namespace

std::vector<double> floor_heights_m(const std::vector<Polygon>& faces) {
  struct Level {
    double amount = 0, moment = 0;
    void add(double much, double z) {
      amount += much;
      moment += much * z;
    }
    double z() const { return moment / amount; }
  };
  std::map<long, Level> floors, walls;
  for (const Polygon& face : faces) {
    Eigen::Vector3d twice = Eigen::Vector3d::Zero();
    double low = face[0].z(), high = low, middle = 0;
    for (std::size_t i = 0; i < face.size(); ++i) {
      twice += (face[i] - face[0]).cross(face[(i + 1) % face.size()] - face[0]);
      low = std::min(low, face[i].z());
      high = std::max(high, face[i].z());
      middle += face[i].z() / static_cast<double>(face.size());
    }
    const double area = 0.5 * twice.norm();
    if (!(area > 0)) continue;
    const double up = 0.5 * twice.z() / area;
    if (up > 0.98) {
      floors[std::lround(middle / level_m)].add(area, middle);
    } else if (std::abs(up) < 0.2 && high - low >= lowest_wall_m) {
      walls[std::lround(low / level_m)].add(area / (high - low), low);
    }
  }
  // Those with most walls first, so that a plinth or the ground around a house, where a few of its
  // walls begin, does not stand for the storey above it.
  std::vector<Level> by_amount;
  for (const auto& [index, wall] : walls) by_amount.push_back(wall);
  std::stable_sort(by_amount.begin(), by_amount.end(),
                   [](const Level& a, const Level& b) { return a.amount > b.amount; });
  const double plan = plan_area(faces);
  std::vector<double> starts;
  struct Storey {
    double height;
    bool has_floor;
  };
  std::vector<Storey> storeys;
  for (const Level& wall : by_amount) {
    if (wall.amount < least_walls * by_amount[0].amount) break;
    if (std::any_of(starts.begin(), starts.end(),
                    [&](double start) { return std::abs(wall.z() - start) < lowest_storey_m; })) {
      continue;
    }
    starts.push_back(wall.z());
    Storey storey{wall.z(), false};
    double largest = least_floor * plan;
    for (const auto& [level, floor] : floors) {
      const double above = floor.z() - wall.z();
      if (above < -floor_below_m || above > floor_above_m || floor.amount < largest) continue;
      largest = floor.amount;
      storey = {floor.z(), true};
    }
    storeys.push_back(storey);
  }
  // Walls that begin without a floor above the highest floor are gables and parapets; below it they
  // are those of a storey without a slab.
  double highest_floor = -std::numeric_limits<double>::infinity();
  for (const Storey& storey : storeys) {
    if (storey.has_floor) highest_floor = std::max(highest_floor, storey.height);
  }
  std::vector<double> heights;
  for (const Storey& storey : storeys) {
    if (storey.height <= highest_floor || !std::isfinite(highest_floor)) {
      heights.push_back(storey.height);
    }
  }
  std::sort(heights.begin(), heights.end());
  return heights;
}

}  // namespace vernier::sim::internal
