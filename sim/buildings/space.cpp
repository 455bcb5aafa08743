// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/buildings/space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>

#include "sim/buildings/building_site.h"
#include "sim/buildings/office_furniture.h"
#include "sim/buildings/wire_shapes.h"

namespace vernier::sim::internal {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// The floor on the lines of a grid that holds all sides of its rectangles.
class CellGrid {
 public:
  explicit CellGrid(const std::vector<AlignedBox2d>& floor) : floor_(floor) {
    for (int axis = 0; axis < 2; ++axis) {
      std::set<double> places;
      for (const AlignedBox2d& part : floor) {
        places.insert(to_grid(part.min()[axis]));
        places.insert(to_grid(part.max()[axis]));
      }
      lines_[axis].assign(places.begin(), places.end());
    }
  }

  int cells(int axis) const { return static_cast<int>(lines_[axis].size()) - 1; }
  double line(int axis, int i) const { return lines_[axis][i]; }

  bool is_floor(int column, int row) const {
    if (column < 0 || row < 0 || column >= cells(0) || row >= cells(1)) return false;
    const Vector2d middle{(line(0, column) + line(0, column + 1)) / 2,
                          (line(1, row) + line(1, row + 1)) / 2};
    return std::any_of(floor_.begin(), floor_.end(),
                       [&](const AlignedBox2d& part) { return part.contains(middle); });
  }

 private:
  const std::vector<AlignedBox2d>& floor_;
  std::array<std::vector<double>, 2> lines_;
};

// Stretches of one grid line along `axis` with floor on one side only. `sign` +1: the floor is on
// the side of larger coordinates.
void walls_along(const CellGrid& grid, int axis, int line, int sign, std::vector<RoomWall>& walls) {
  const auto is_wall = [&](int cell) {
    const int inside = sign > 0 ? line : line - 1, outside = sign > 0 ? line - 1 : line;
    return axis == 0 ? grid.is_floor(cell, inside) && !grid.is_floor(cell, outside)
                     : grid.is_floor(inside, cell) && !grid.is_floor(outside, cell);
  };
  const double at = grid.line(1 - axis, line);
  for (int cell = 0; cell < grid.cells(axis); ++cell) {
    if (!is_wall(cell)) continue;
    const double from = grid.line(axis, cell);
    while (cell < grid.cells(axis) && is_wall(cell)) ++cell;
    const double to = grid.line(axis, cell);
    // Interior to the left: along +x with floor above, along -x with floor below, and likewise y.
    if (axis == 0 && sign > 0) walls.push_back({{{from, at, 0}, 0}, to - from});
    if (axis == 0 && sign < 0) walls.push_back({{{to, at, 0}, 2}, to - from});
    if (axis == 1 && sign < 0) walls.push_back({{{at, from, 0}, 1}, to - from});
    if (axis == 1 && sign > 0) walls.push_back({{{at, to, 0}, 3}, to - from});
  }
}

// A line along a wall, interrupted at its openings; these are in the order of their places.
void wall_line(Shapes& shapes,
               double length,
               const std::vector<Opening>& openings,
               bool around_casing,
               double z) {
  double from = 0;
  for (const Opening& opening : openings) {
    const double half = opening.width_m / 2 + (around_casing ? opening.frame_m : 0);
    if (opening.middle_m - half > from) {
      shapes.line({from, 0, z}, {opening.middle_m - half, 0, z});
    }
    from = opening.middle_m + half;
  }
  if (length > from) shapes.line({from, 0, z}, {length, 0, z});
}

// The face of a wall, y = 0 of its frame.
void wall_face(Shapes& shapes, double x0, double x1, double z0, double z1) {
  if (x1 > x0 && z1 > z0) shapes.surfaces_of_box({x0, 0, z0}, {x1, 0, z1}, back_face);
}

void raise_wall(Shapes& shapes,
                const RoomWall& wall,
                double height,
                std::vector<Opening> openings) {
  std::sort(openings.begin(), openings.end(),
            [](const Opening& a, const Opening& b) { return a.middle_m < b.middle_m; });
  shapes.frame = wall.frame;
  double from = 0;
  for (const Opening& opening : openings) {
    const double x0 = opening.middle_m - opening.width_m / 2, x1 = x0 + opening.width_m;
    wall_face(shapes, from, x0, 0, height);
    wall_face(shapes, x0, x1, opening.height_m, height);
    if (opening.frame_m == 0) {
      // Nothing frames it: its own edges are what is seen.
      for (const double x : {x0, x1}) shapes.line({x, 0, 0}, {x, 0, opening.height_m});
      shapes.line({x0, 0, opening.height_m}, {x1, 0, opening.height_m});
    }
    from = x1;
  }
  wall_face(shapes, from, wall.length_m, 0, height);
  wall_line(shapes, wall.length_m, openings, false, 0);
  wall_line(shapes, wall.length_m, openings, true, skirting_m);
  shapes.line({0, 0, height}, {wall.length_m, 0, height});
  shapes.line({0, 0, 0}, {0, 0, height});
}

}  // namespace

std::vector<RoomWall> walls_around(const std::vector<AlignedBox2d>& floor_m) {
  const CellGrid grid(floor_m);
  std::vector<RoomWall> walls;
  for (int line = 0; line <= grid.cells(1); ++line) walls_along(grid, 0, line, 1, walls);
  for (int line = 0; line <= grid.cells(0); ++line) walls_along(grid, 1, line, -1, walls);
  for (int line = 0; line <= grid.cells(1); ++line) walls_along(grid, 0, line, -1, walls);
  for (int line = 0; line <= grid.cells(0); ++line) walls_along(grid, 1, line, 1, walls);
  return walls;
}

std::vector<Opening> end_openings(const std::vector<RoomWall>& walls,
                                  const Vector3d& size_m,
                                  const OpenEnds& open) {
  std::vector<Opening> openings;
  const double middle = size_m.y() / 2;
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const Vector3d& origin = walls[i].frame.origin_m;
    const int quarters = walls[i].frame.quarters;
    const bool at_low = quarters == 3 && origin.x() == 0 && open.low_x;
    const bool at_high = quarters == 1 && origin.x() == to_grid(size_m.x()) && open.high_x;
    if (!at_low && !at_high) continue;
    const double along = std::abs(middle - origin.y());
    const bool holds = at_low ? middle < origin.y() && along < walls[i].length_m
                              : middle > origin.y() && along < walls[i].length_m;
    if (holds) openings.push_back({i, to_grid(along)});
  }
  return openings;
}

void raise_room(Shapes& shapes,
                const std::vector<AlignedBox2d>& floor_m,
                const std::vector<RoomWall>& walls,
                double height_m,
                const std::vector<Opening>& openings) {
  shapes.frame = {};
  for (const AlignedBox2d& part : floor_m) {
    shapes.surfaces_of_box({part.min().x(), part.min().y(), 0},
                           {part.max().x(), part.max().y(), height_m}, bottom_face | top_face);
  }
  for (std::size_t i = 0; i < walls.size(); ++i) {
    std::vector<Opening> own;
    std::copy_if(openings.begin(), openings.end(), std::back_inserter(own),
                 [&](const Opening& opening) { return opening.wall == i; });
    raise_wall(shapes, walls[i], height_m, own);
  }
}

void raise_reveals(Shapes& shapes, const RoomWall& wall, const Opening& opening) {
  shapes.frame = wall.frame;
  const double x0 = opening.middle_m - opening.width_m / 2, x1 = x0 + opening.width_m;
  shapes.surfaces_of_box({x0, -wall_thickness_m, 0}, {x1, 0, opening.height_m},
                         left_face | right_face | top_face | bottom_face);
}

void fit_end_doorways(BuildingSite& site,
                      const std::vector<RoomWall>& walls,
                      const std::vector<Opening>& openings,
                      double beside_m,
                      double before_m) {
  constexpr double above_m = 2.2;
  for (const Opening& opening : openings) {
    const RoomWall& wall = walls[opening.wall];
    const double half = opening.width_m / 2 + beside_m;
    site.occupy(wall.frame *
                Eigen::AlignedBox3d(Vector3d(opening.middle_m - half, 0, 0),
                                    Vector3d(opening.middle_m + half, before_m, above_m)));
    if (wall.frame.quarters != 1) continue;
    raise_reveals(site.loose(), wall, opening);
    site.place("door_frame", wall.frame, {opening.middle_m, 0, 0});
  }
}

void raise_outer_walls(Shapes& shapes, const Vector3d& size_m, const OpenEnds& open) {
  shapes.surfaces_of_box(
      Vector3d::Zero(), size_m,
      all_faces - (open.low_x ? left_face : no_face) - (open.high_x ? right_face : no_face));
  const double y0 = to_grid(size_m.y() / 2) - door_width_m / 2, y1 = y0 + door_width_m;
  for (const bool high : {false, true}) {
    if (!(high ? open.high_x : open.low_x)) continue;
    const double x = high ? size_m.x() : 0;
    shapes.surfaces_of_box({x, 0, 0}, {x, y0, size_m.z()}, left_face);
    shapes.surfaces_of_box({x, y1, 0}, {x, size_m.y(), size_m.z()}, left_face);
    shapes.surfaces_of_box({x, y0, door_height_m}, {x, y1, size_m.z()}, left_face);
    if (!high) continue;  // one of the two parts that meet draws the reveals
    const double beyond = x + wall_thickness_m;
    shapes.surfaces_of_box({x, y0, 0}, {beyond, y1, door_height_m},
                           back_face | front_face | bottom_face | top_face);
  }
}

}  // namespace vernier::sim::internal
