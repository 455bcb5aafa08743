// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/import/storeys.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <map>
#include <vector>

#include "sim/import/levels.h"
#include "sim/import/mesh.h"

namespace vernier::sim::internal {

namespace {

constexpr double level_m = 0.05;  // heights are told apart to this
constexpr double lowest_wall_m = 1.5;
constexpr double least_walls = 0.2;   // length at their lower ends, of that of the storey with most
constexpr double least_floor = 0.25;  // level surface, of the bounding box of the walls on it
constexpr double least_passed_floor = 0.5;  // that walls pass by, of the floor below it
constexpr double thickest_slab_m = 0.4;
constexpr std::size_t most_passed_levels = 200;             // of which the largest are looked at
constexpr double floor_below_m = 0.1, floor_above_m = 0.4;  // of where walls begin or end

long bin_of(double z) { return std::lround(z / level_m); }

/// What lies at a height: how much, and its mean height.
struct AtHeight {
  double amount = 0, moment = 0;
  void add(double much, double z) {
    amount += much;
    moment += much * z;
  }
  double z() const { return moment / amount; }
};
using ByHeight = std::map<long, AtHeight>;

/// Walls that begin at a height: their length, their plan's bounding box, and where those end whose
/// upper edge is level.
struct Walls {
  AtHeight begin;
  Eigen::AlignedBox2d box;
  ByHeight level_ends;
};

struct Wall {
  double low, high, length;
  Eigen::AlignedBox2d box;
};

/// The surfaces of a building by their heights.
struct Surfaces {
  ByHeight up, level;  // level surface that faces up, and all
  std::map<long, Walls> walls;
  std::vector<Wall> single_walls;
};

/// Length of a face's edges at its upper end.
double upper_edge(const Polygon& face, double high) {
  double length = 0;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const Eigen::Vector3d &a = face[i], &b = face[(i + 1) % face.size()];
    if (std::min(a.z(), b.z()) > high - level_m) length += (b - a).norm();
  }
  return length;
}

void add_wall(const Polygon& face, double area, double low, double high, Surfaces& surfaces) {
  const double length = area / (high - low);
  Walls& walls = surfaces.walls[bin_of(low)];
  walls.begin.add(length, low);
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector3d& v : face) box.extend(v.head<2>());
  walls.box.extend(box);
  surfaces.single_walls.push_back({low, high, length, box});
  if (upper_edge(face, high) > 0.5 * length) walls.level_ends[bin_of(high)].add(length, high);
}

Surfaces surfaces_of(const std::vector<Polygon>& faces) {
  Surfaces surfaces;
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
    if (std::abs(up) > floor_cosine) {
      surfaces.level[bin_of(middle)].add(area, middle);
      if (up > 0) surfaces.up[bin_of(middle)].add(area, middle);
    } else if (std::abs(up) < wall_cosine && high - low >= lowest_wall_m) {
      add_wall(face, area, low, high, surfaces);
    }
  }
  return surfaces;
}

/// The largest of the levels at a height that are floors for such walls; null without one.
const AtHeight* floor_at(const ByHeight& levels, double z, const Walls& walls) {
  const AtHeight* found = nullptr;
  double largest = least_floor * walls.box.volume();
  for (const auto& [bin, level] : levels) {
    const double above = level.z() - z;
    if (above < -floor_below_m || above > floor_above_m || level.amount < largest) continue;
    largest = level.amount;
    found = &level;
  }
  return found;
}

/// Whether most of such walls end level, below level surface: gables do not, nor do parapets.
bool carry_a_ceiling(const Walls& walls, const Surfaces& surfaces) {
  double carrying = 0;
  for (const auto& [bin, end] : walls.level_ends) {
    if (floor_at(surfaces.level, end.z(), walls) != nullptr) carrying += end.amount;
  }
  return carrying > 0.5 * walls.begin.amount;
}

/// The heights at which most walls begin, those with most first, so that a plinth or the ground
/// around a house, where a few of its walls begin, does not stand for the storey above it.
std::vector<Walls> starts_of(const Surfaces& surfaces) {
  std::vector<Walls> by_amount, starts;
  for (const auto& [bin, walls] : surfaces.walls) by_amount.push_back(walls);
  std::stable_sort(by_amount.begin(), by_amount.end(),
                   [](const Walls& a, const Walls& b) { return a.begin.amount > b.begin.amount; });
  for (const Walls& walls : by_amount) {
    if (walls.begin.amount < least_walls * by_amount[0].begin.amount) break;
    const bool is_near = std::any_of(starts.begin(), starts.end(), [&](const Walls& start) {
      return std::abs(walls.begin.z() - start.begin.z()) < lowest_storey_m;
    });
    if (!is_near) starts.push_back(walls);
  }
  return starts;
}

/// The area of what lies below a passed floor: of the smallest surface at the height of the floor
/// below that is large enough to be it, since the ground around a house may lie there too; without
/// any that of the plan's box.
double area_below(const Surfaces& surfaces, double z, const Eigen::AlignedBox2d& box) {
  double area = box.volume();
  for (const auto& [bin, level] : surfaces.level) {
    if (std::abs(level.z() - z) > floor_above_m || level.amount < least_floor * box.volume())
      continue;
    area = std::min(area, level.amount);
  }
  return area;
}

/// Whether walls of two storeys pass by a level surface, which is half as large as the floor below:
/// façades, and walls that stand on each other without a slab between them.
bool is_passed_floor(const AtHeight& level,
                     double below,
                     double least_length,
                     const Surfaces& surfaces) {
  const double z = level.z();
  double length = 0;
  Eigen::AlignedBox2d box;
  for (const Wall& wall : surfaces.single_walls) {
    if (wall.low > z - lowest_storey_m || wall.high < z + lowest_storey_m - thickest_slab_m) {
      continue;
    }
    length += wall.length;
    box.extend(wall.box);
  }
  return length >= least_length &&
         level.amount >= least_passed_floor * area_below(surfaces, below, box);
}

/// Adds the floors by which walls pass, the largest first, to those on which walls begin.
void add_passed_floors(const Surfaces& surfaces,
                       double least_length,
                       std::vector<double>& heights) {
  std::vector<AtHeight> levels;
  for (const ByHeight* of : {&surfaces.up, &surfaces.level}) {  // a sheet may face down
    std::vector<AtHeight> some;
    for (const auto& [bin, level] : *of) some.push_back(level);
    std::stable_sort(some.begin(), some.end(),
                     [](const AtHeight& a, const AtHeight& b) { return a.amount > b.amount; });
    some.resize(std::min(some.size(), most_passed_levels));
    levels.insert(levels.end(), some.begin(), some.end());
  }
  for (const AtHeight& level : levels) {
    const double z = level.z();
    double below = -std::numeric_limits<double>::infinity();
    bool is_near = false;
    for (const double height : heights) {
      is_near = is_near || std::abs(height - z) < lowest_storey_m;
      if (height < z) below = std::max(below, height);
    }
    if (is_near || std::isinf(below)) continue;
    if (is_passed_floor(level, below, least_length, surfaces)) heights.push_back(z);
  }
}

}  // namespace

std::vector<double> floor_heights_m(const std::vector<Polygon>& faces) {
  const Surfaces surfaces = surfaces_of(faces);
  const std::vector<Walls> starts = starts_of(surfaces);
  const double most_walls = starts.empty() ? 0 : starts[0].begin.amount;
  std::vector<double> heights, without_floor;
  for (const Walls& walls : starts) {
    if (const AtHeight* floor = floor_at(surfaces.up, walls.begin.z(), walls)) {
      heights.push_back(floor->z());
    } else if (carry_a_ceiling(walls, surfaces)) {
      heights.push_back(walls.begin.z());
    } else {
      without_floor.push_back(walls.begin.z());
    }
  }
  // Below the highest floor they are those of a storey without a slab; above it gables.
  const double highest = heights.empty() ? std::numeric_limits<double>::infinity()
                                         : *std::max_element(heights.begin(), heights.end());
  std::copy_if(without_floor.begin(), without_floor.end(), std::back_inserter(heights),
               [&](double height) { return height <= highest; });
  add_passed_floors(surfaces, least_walls * most_walls, heights);
  std::sort(heights.begin(), heights.end());
  return heights;
}

}  // namespace vernier::sim::internal
