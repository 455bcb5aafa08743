// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "sim/routing/closed_bodies.h"
#include "sim/world.h"

namespace vernier::sim::internal {

/// The floor in square cells: where a robot can stand, and how far from what is in its way.
class FloorPlan {
 public:
  static constexpr double cell_m = 0.15;
  static constexpr double widest_gap_m = 2;    ///< through which the surroundings do not come in
  static constexpr double widest_gate_m = 10;  ///< of halls; wider gaps are between buildings

  /// The robot's camera is at `eye_height_m`. Of a world without surfaces its lines on the floor
  /// and at the robot's height stand for walls. Throws Error if the floor is larger than about
  /// 27,000 m².
  FloorPlan(const World& world, double eye_height_m);

  int width() const { return width_; }
  int height() const { return height_; }
  bool has(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }
  Eigen::Vector2d centre_m(int x, int y) const;

  /// Whether the cell belongs to the largest part of the floor that is inside: free, not over a
  /// hole in a floor that most of it has, not in a solid body, and not connected with the
  /// surroundings of the world through gaps wider than 2 m, so that outer doors may stand open.
  /// Floor whose own gap is wider is inside too if walls are around four fifths of it and it has a
  /// ceiling where rooms have. In a world without such floor, free and over a floor.
  bool inside(int x, int y) const { return inside_[index(x, y)]; }
  /// Distance from a cell of the inside to the nearest cell that is not free, metres.
  double clearance_m(int x, int y) const { return clearance_[index(x, y)]; }
  double inside_m2() const;
  /// Of what could be inside too, but has no way to it that a robot fits through: rooms behind
  /// closed doors, other buildings, what may be a room or a block.
  double other_m2() const { return other_m2_; }
  /// Of what borders on the inside: at another level, so lower, a hole, or a step higher; and floor
  /// that is open to the surroundings.
  double level_m2() const { return level_m2_; }
  double open_m2() const { return open_m2_; }
  /// Whether the inside is open to the surroundings by a gap wider than 2 m; and the width of the
  /// gap, to about 0.3 m, or less where furniture narrows the way (0: there are no walls around).
  bool is_open() const { return is_open_; }
  double gap_m() const { return gap_m_; }

 private:
  struct Part {
    std::vector<std::size_t> cells;
    Enclosure enclosure;
    bool is_wide;   // enough to stand in beside its walls
    bool is_open;   // to the surroundings
    bool is_block;  // perhaps: a shell on ground
  };
  struct Gate {
    std::size_t cell;  // behind it
    double width_m;
  };
  /// Around the plan, so that a disc as wide as a gate can go around the world.
  static constexpr int rim_cells = static_cast<int>(widest_gate_m / 2 / cell_m);
  static constexpr std::array<std::pair<int, int>, 4> four_sides{
      {{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

  int column_of(std::size_t i) const {
    return static_cast<int>(i % static_cast<std::size_t>(width_));
  }
  int row_of(std::size_t i) const { return static_cast<int>(i / static_cast<std::size_t>(width_)); }
  void choose_inside(const World& world);
  void take_largest(const std::vector<Part>& parts, bool has_room, const std::vector<Gate>& gates);
  std::vector<Part> sorted_out(const std::vector<bool>& cells,
                               const std::vector<bool>& outside,
                               const std::vector<bool>& floored,
                               const ClosedBodies& bodies) const;
  bool is_on_ground(const std::vector<std::size_t>& part, const std::vector<bool>& floored) const;
  /// Whether a part of the cells borders on free floor of the surroundings that is none of them.
  bool has_way_out(const std::vector<std::size_t>& part,
                   const std::vector<bool>& cells,
                   const std::vector<bool>& outside) const;
  Enclosure enclosure_of(const std::vector<std::size_t>& part, const ClosedBodies& bodies) const;
  std::vector<Gate> add_behind_gates(const std::vector<bool>& floor,
                                     const std::vector<Part>& parts,
                                     const std::vector<bool>& below_ceiling,
                                     std::vector<bool>& indoors) const;
  /// Whether a part of the cells is open, but to what is indoors, along less than a fifth.
  bool is_walled(const std::vector<std::size_t>& part,
                 const std::vector<bool>& cells,
                 const std::vector<bool>& indoors) const;
  std::vector<float> closing_gaps_m() const;
  static double gap_into(const std::vector<std::size_t>& cells,
                         const std::vector<float>& closing_m);
  void block_below(const World& world, double top_m);
  std::vector<bool> without_floor(const std::vector<bool>& floored,
                                  const std::vector<bool>& indoors,
                                  const std::vector<Part>& parts) const;
  std::vector<bool> other_levels(const World& world, const std::vector<bool>& bare) const;
  double beside_m2(const std::vector<bool>& cells, double within_m) const;
  std::vector<bool> near(const std::vector<bool>& floored) const;
  void visit_cells(const WorldSurface& surface, const std::function<void(int, int)>& visit) const;
  /// Adds to the cells that are reached those that border on them, and takes them out of what is
  /// left, until nothing that is left borders on them.
  void flood(std::vector<std::size_t>& reached, std::vector<bool>& left) const;
  /// What gaps wider than `gap_m` connect with the surroundings of the world; `room_m` is the
  /// distance from each free cell to the nearest that is not.
  std::vector<bool> outdoors(double gap_m, const std::vector<float>& room_m) const;
  /// Cells over surfaces that lie between two heights.
  std::vector<bool> over_floor(const World& world, double low_m, double high_m) const;
  /// Connected parts, the largest first.
  std::vector<std::vector<std::size_t>> parts_of(const std::vector<bool>& cells) const;
  /// From each cell of a set to the nearest of the others (0 in these), by two passes of chamfer
  /// steps (Borgefors, Computer Vision, Graphics, and Image Processing 34, 1986), 8 % too long or
  /// short at most. What lies beyond the plan counts as one of the others unless it is endless.
  std::vector<float> distances_to_others(const std::vector<bool>& cells,
                                         bool is_endless = false) const;

  Eigen::Vector2d low_m_;  // corner within the rim
  int width_ = 0, height_ = 0;
  std::vector<bool> free_, inside_;
  std::vector<float> clearance_;
  bool is_open_ = false;
  double gap_m_ = 0, other_m2_ = 0, level_m2_ = 0, open_m2_ = 0;
};

}  // namespace vernier::sim::internal
