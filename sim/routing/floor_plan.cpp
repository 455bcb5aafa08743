// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/routing/floor_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>

#include "calib/error.h"
#include "sim/study/free_floor.h"
#include "sim/study/standing_place.h"
#include "sim/visibility/convex_pieces.h"
#include "sim/world.h"

namespace vernier::sim::internal {

namespace {

constexpr double around_m = 2;  // of the plan, around the world, besides its rim

/// Lines of a world without surfaces as what stands on the floor.
World with_walls(const World& world, double top_m) {
  constexpr double low_m = -0.1, thin_m = 0.01, wall_m = 1;
  World walls = world;
  for (const WorldSegment& segment : world.segments) {
    Eigen::Vector3d a = segment.a_m, b = segment.b_m;
    const auto [low, high] = std::minmax(a.z(), b.z());
    if (high < low_m || low > top_m) continue;
    if ((b - a).head<2>().norm() < thin_m) b.x() = a.x() + thin_m;
    a.z() = 0;
    b.z() = 0;
    const Eigen::Vector3d up(0, 0, wall_m);
    walls.surfaces.push_back({{a, b, b + up, a + up}, segment.object});
  }
  return walls;
}

}  // namespace

FloorPlan::FloorPlan(const World& world, double eye_height_m) {
  constexpr double most_cells = 1.2e6;
  const WorldExtent box = standing_box(world);
  const Eigen::Vector2d size = (box.high_m - box.low_m).head<2>();
  const auto across = [](double length_m) { return (length_m + 2 * around_m) / cell_m; };
  if (!(across(size.x()) * across(size.y()) <= most_cells)) {
    throw Error("route",
                fmt::format("the floor of {:.0f} x {:.0f} m is too large to propose one", size.x(),
                            size.y()),
                "give [[route]] points_m yourself");
  }
  low_m_ = box.low_m.head<2>() - Eigen::Vector2d::Constant(around_m);
  width_ = static_cast<int>(across(size.x())) + 1 + 2 * rim_cells;
  height_ = static_cast<int>(across(size.y())) + 1 + 2 * rim_cells;
  const World walls =
      world.surfaces.empty() ? with_walls(world, eye_height_m + robot_top_m) : world;
  const Standing standing(walls, eye_height_m);
  const auto count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  free_.resize(count);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) free_[index(x, y)] = standing.is_free(centre_m(x, y));
  }
  block_below(world, eye_height_m + robot_top_m);
  choose_inside(world);
  clearance_ = distances_to_others(inside_);
}

/// Cells where a surface lies between the floor and the robot's top: a ceiling, a roof, a ramp.
void FloorPlan::block_below(const World& world, double top_m) {
  constexpr double floor_m = 0.02, upright = 0.05;
  for (const WorldSurface& surface : world.surfaces) {
    const PolygonPlane plane = polygon_plane(surface.polygon_m);
    if (std::abs(plane.normal.z()) < upright) continue;
    visit_cells(surface, [&](int x, int y) {
      const Eigen::Vector2d at = centre_m(x, y);
      const double z = (plane.distance_m - plane.normal.head<2>().dot(at)) / plane.normal.z();
      if (z > floor_m && z < top_m) free_[index(x, y)] = false;
    });
  }
}

Eigen::Vector2d FloorPlan::centre_m(int x, int y) const {
  return low_m_ + cell_m * Eigen::Vector2d(x - rim_cells + 0.5, y - rim_cells + 0.5);
}

double FloorPlan::inside_m2() const {
  return cell_m * cell_m * static_cast<double>(std::count(inside_.begin(), inside_.end(), true));
}

void FloorPlan::flood(std::vector<std::size_t>& reached, std::vector<bool>& left) const {
  for (std::size_t next = 0; next < reached.size(); ++next) {
    const int x = column_of(reached[next]), y = row_of(reached[next]);
    for (const auto& [dx, dy] : four_sides) {
      if (!has(x + dx, y + dy) || !left[index(x + dx, y + dy)]) continue;
      left[index(x + dx, y + dy)] = false;
      reached.push_back(index(x + dx, y + dy));
    }
  }
}

std::vector<bool> FloorPlan::outdoors(double gap_m, const std::vector<float>& room_m) const {
  std::vector<bool> left(free_.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = room_m[i] >= gap_m / 2;
  std::vector<std::size_t> outside;
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const bool is_border = x == 0 || y == 0 || x == width_ - 1 || y == height_ - 1;
      if (!is_border || !left[index(x, y)]) continue;
      left[index(x, y)] = false;
      outside.push_back(index(x, y));
    }
  }
  flood(outside, left);
  std::vector<bool> reached(free_.size());
  for (const std::size_t i : outside) reached[i] = true;
  // and what is so close to it that it cannot be a room
  std::vector<bool> others(reached.size());
  for (std::size_t i = 0; i < reached.size(); ++i) others[i] = !reached[i];
  const std::vector<float> away = distances_to_others(others, true);
  for (std::size_t i = 0; i < reached.size(); ++i) {
    reached[i] = reached[i] || (free_[i] && away[i] <= gap_m / 2);
  }
  return reached;
}

std::vector<bool> FloorPlan::over_floor(const World& world, double low_m, double high_m) const {
  std::vector<bool> floored(free_.size());
  for (const WorldSurface& surface : world.surfaces) {
    const auto [low, high] =
        std::minmax_element(surface.polygon_m.begin(), surface.polygon_m.end(),
                            [](const auto& a, const auto& b) { return a.z() < b.z(); });
    if (high->z() > high_m || low->z() < low_m) continue;
    visit_cells(surface, [&](int x, int y) { floored[index(x, y)] = true; });
  }
  return floored;
}

/// Calls visit(x, y) for the cells whose centre is over or below a surface.
void FloorPlan::visit_cells(const WorldSurface& surface,
                            const std::function<void(int, int)>& visit) const {
  Eigen::Vector2d low = surface.polygon_m[0].head<2>(), high = low;
  for (const Eigen::Vector3d& p : surface.polygon_m) {
    low = low.cwiseMin(p.head<2>());
    high = high.cwiseMax(p.head<2>());
  }
  const auto column = [&](double at, double from, int most) {
    return std::clamp(static_cast<int>(std::floor((at - from) / cell_m)) + rim_cells, 0, most - 1);
  };
  for (int y = column(low.y(), low_m_.y(), height_); y <= column(high.y(), low_m_.y(), height_);
       ++y) {
    for (int x = column(low.x(), low_m_.x(), width_); x <= column(high.x(), low_m_.x(), width_);
         ++x) {
      if (inside_plan(centre_m(x, y), surface.polygon_m)) visit(x, y);
    }
  }
}

std::vector<std::vector<std::size_t>> FloorPlan::parts_of(const std::vector<bool>& cells) const {
  std::vector<bool> left = cells;
  std::vector<std::vector<std::size_t>> parts;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!left[i]) continue;
    left[i] = false;
    parts.push_back({i});
    flood(parts.back(), left);
  }
  std::stable_sort(parts.begin(), parts.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return parts;
}

std::vector<float> FloorPlan::distances_to_others(const std::vector<bool>& cells,
                                                  bool is_endless) const {
  constexpr float far = 1e6f;
  const auto straight = static_cast<float>(cell_m), slanted = static_cast<float>(cell_m * 4 / 3);
  std::vector<float> distances(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) distances[i] = cells[i] ? far : 0;
  const auto shorten = [&](int x, int y, int dx, int dy) {
    const bool is_there = has(x + dx, y + dy);
    if (!is_there && is_endless) return;
    const float there = is_there ? distances[index(x + dx, y + dy)] : 0;
    float& here = distances[index(x, y)];
    here = std::min(here, there + (dx != 0 && dy != 0 ? slanted : straight));
  };
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      for (const auto& [dx, dy] : {std::pair(-1, 0), {-1, -1}, {0, -1}, {1, -1}}) {
        shorten(x, y, dx, dy);
      }
    }
  }
  for (int y = height_ - 1; y >= 0; --y) {
    for (int x = width_ - 1; x >= 0; --x) {
      for (const auto& [dx, dy] : {std::pair(1, 0), {1, 1}, {0, 1}, {-1, 1}}) {
        shorten(x, y, dx, dy);
      }
    }
  }
  return distances;
}

}  // namespace vernier::sim::internal
