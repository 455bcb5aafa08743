// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Which of the floor is inside.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "sim/routing/closed_bodies.h"
#include "sim/routing/floor_plan.h"
#include "sim/study/standing_place.h"
#include "sim/world.h"

namespace vernier::sim::internal {

namespace {

constexpr double cell_m2 = FloorPlan::cell_m * FloorPlan::cell_m;
constexpr double least_room_m2 = 4;
constexpr double ceiling_m = 1.8;  // low, and above tables
constexpr double endless_m = std::numeric_limits<double>::infinity();
constexpr double gap_step_m = 0.25;  // in which wider gaps are tried

/// Whether one can stand in a part beside its walls; the inside of a wall is narrower.
bool holds_a_robot(const std::vector<std::size_t>& part, const std::vector<float>& clearances_m) {
  constexpr float half_m = 0.3f;
  return std::any_of(part.begin(), part.end(),
                     [&](std::size_t i) { return clearances_m[i] >= half_m; });
}

/// Whether more than half of some cells are in a set.
bool most_are(const std::vector<std::size_t>& cells, const std::vector<bool>& set) {
  const auto count =
      std::count_if(cells.begin(), cells.end(), [&](std::size_t i) { return set[i]; });
  return 2 * static_cast<std::size_t>(count) > cells.size();
}

double size_m2(const std::vector<std::size_t>& cells) {
  return cell_m2 * static_cast<double>(cells.size());
}

}  // namespace

/// Takes rooms that are enclosed, with the floor behind their gates, or what has walls around but
/// for a gate. Where there are none, floor that is open to the surroundings.
/// A shell of single sheets may be a room or a block: it is inside if it is larger.
void FloorPlan::choose_inside(const World& world) {
  constexpr double thick_m = 0.1;  // the floor's coverings, and what the file rounds
  const std::vector<bool> floored = over_floor(world, -thick_m, thick_m);
  const std::vector<bool> outside = outdoors(widest_gap_m, distances_to_others(free_, true));
  std::vector<bool> indoors(free_.size()), open(free_.size());
  for (std::size_t i = 0; i < free_.size(); ++i) {
    indoors[i] = free_[i] && !outside[i];
    open[i] = free_[i] && floored[i];
  }
  const ClosedBodies bodies(world);
  std::vector<Part> parts = sorted_out(indoors, outside, floored, bodies);
  const std::vector<bool> bare = without_floor(floored, indoors, parts);
  for (std::size_t i = 0; i < free_.size(); ++i) indoors[i] = indoors[i] && !bare[i];
  parts = sorted_out(indoors, outside, floored, bodies);
  const auto is_room = [](const Part& part) {
    return part.enclosure == Enclosure::none && size_m2(part.cells) >= least_room_m2;
  };
  const bool has_room = std::any_of(parts.begin(), parts.end(), is_room);
  if (!has_room) {
    std::erase_if(parts, [](const Part& part) { return part.enclosure == Enclosure::none; });
    for (const Part& part : parts) {
      for (const std::size_t i : part.cells) open[i] = false;
    }
  }
  std::vector<Part> open_parts = sorted_out(open, outside, floored, bodies);
  const bool has_open = std::any_of(open_parts.begin(), open_parts.end(), is_room);
  const std::vector<bool> below_ceiling = over_floor(world, ceiling_m, endless_m);
  const std::vector<Gate> gates =
      add_behind_gates(has_open ? near(floored) : free_, parts, below_ceiling, indoors);
  if (!gates.empty()) {
    parts = sorted_out(indoors, outside, floored, bodies);
  } else if (!has_room && has_open) {
    for (Part& part : open_parts) part.is_open = true;
    parts.insert(parts.end(), open_parts.begin(), open_parts.end());
  }
  take_largest(parts, has_room, gates);
  // The robot keeps its radius, in cells, from an edge.
  level_m2_ = beside_m2(other_levels(world, bare), 2 * cell_m);
  for (std::size_t i = 0; i < free_.size(); ++i) {
    open[i] = free_[i] && floored[i] && !inside_[i] && !indoors[i];
  }
  open_m2_ = beside_m2(open, cell_m);
}

/// Makes the largest part that is as large as a room the inside, a solid body only if there is
/// nothing else, and adds up the others.
void FloorPlan::take_largest(const std::vector<Part>& parts,
                             bool has_room,
                             const std::vector<Gate>& gates) {
  constexpr double least_other_m2 = 1;  // more than what is left behind a table
  const auto is_taken = [&](const Part& part) {
    return size_m2(part.cells) >= least_room_m2 && part.enclosure != Enclosure::body &&
           !part.is_block && !(has_room && part.enclosure == Enclosure::outward_shell);
  };
  const auto is_less = [&](const Part& a, const Part& b) {
    return std::pair(is_taken(a), a.cells.size()) < std::pair(is_taken(b), b.cells.size());
  };
  const auto best = std::max_element(parts.begin(), parts.end(), is_less);
  inside_.assign(free_.size(), false);
  if (best == parts.end() || size_m2(best->cells) < least_room_m2) return;
  for (const std::size_t i : best->cells) inside_[i] = true;
  for (auto part = parts.begin(); part != parts.end(); ++part) {
    if (part == best || !part->is_wide || size_m2(part->cells) < least_other_m2) continue;
    if (part->enclosure != Enclosure::body || best->enclosure == Enclosure::body) {
      other_m2_ += size_m2(part->cells);
    }
  }
  for (const Gate& gate : gates) {
    if (inside_[gate.cell]) gap_m_ = std::max(gap_m_, gate.width_m);
  }
  is_open_ = best->is_open || gap_m_ > 0;
  if (best->is_open) gap_m_ = gap_into(best->cells, closing_gaps_m());
}

/// The connected parts of cells, the largest ones, and what encloses them.
std::vector<FloorPlan::Part> FloorPlan::sorted_out(const std::vector<bool>& cells,
                                                   const std::vector<bool>& outside,
                                                   const std::vector<bool>& floored,
                                                   const ClosedBodies& bodies) const {
  constexpr std::size_t most = 200;  // the others are small
  constexpr std::size_t least = 22;  // half a square metre
  std::vector<std::vector<std::size_t>> found = parts_of(cells);
  const std::vector<float> clearances = distances_to_others(cells);
  std::vector<Part> parts;
  for (std::vector<std::size_t>& part : found) {
    if (parts.size() == most || part.size() < least) break;
    const bool is_wide = holds_a_robot(part, clearances);
    // A room of walls without thickness looks like a solid body from within, but for its door.
    Enclosure enclosure =
        has_way_out(part, cells, outside) ? Enclosure::none : enclosure_of(part, bodies);
    if (enclosure == Enclosure::outward_shell && !most_are(part, floored)) {
      enclosure = Enclosure::body;
    }
    const bool is_block = enclosure == Enclosure::outward_shell && is_on_ground(part, floored);
    parts.push_back({std::move(part), enclosure, is_wide, false, is_block});
  }
  return parts;
}

bool FloorPlan::has_way_out(const std::vector<std::size_t>& part,
                            const std::vector<bool>& cells,
                            const std::vector<bool>& outside) const {
  return std::any_of(part.begin(), part.end(), [&](std::size_t i) {
    const int x = column_of(i), y = row_of(i);
    return std::any_of(four_sides.begin(), four_sides.end(), [&](const auto& step) {
      if (!has(x + step.first, y + step.second)) return false;
      const std::size_t next = index(x + step.first, y + step.second);
      return free_[next] && outside[next] && !cells[next];
    });
  });
}

/// What encloses most of 20 cells of a part, evenly chosen, at the robot's height; nothing if they
/// differ.
Enclosure FloorPlan::enclosure_of(const std::vector<std::size_t>& part,
                                  const ClosedBodies& bodies) const {
  constexpr std::size_t samples = 20;
  constexpr double height_m = 0.5;
  const std::size_t step = std::max<std::size_t>(1, part.size() / samples);
  std::array<std::size_t, 4> counts{};
  std::size_t looked = 0;
  for (std::size_t k = step / 2; k < part.size(); k += step) {
    const Eigen::Vector2d at = centre_m(column_of(part[k]), row_of(part[k]));
    // Off the middle of the cell, lest a ray meets the edge between two surfaces.
    ++counts[static_cast<std::size_t>(
        bodies.enclosure({at.x() + 0.0137, at.y() + 0.0173, height_m}))];
    ++looked;
  }
  for (const Enclosure each :
       {Enclosure::body, Enclosure::outward_shell, Enclosure::inward_shell}) {
    if (2 * counts[static_cast<std::size_t>(each)] > looked) return each;
  }
  return Enclosure::none;
}

/// Whether the floor of a part goes on past the walls around it along more than half of them, as
/// ground on which a block stands.
bool FloorPlan::is_on_ground(const std::vector<std::size_t>& part,
                             const std::vector<bool>& floored) const {
  constexpr int beyond = 4;  // cells: past a wall and the robot's distance from its two sides
  std::vector<bool> within(free_.size());
  for (const std::size_t i : part) within[i] = true;
  std::size_t outline = 0, ground = 0;
  for (const std::size_t i : part) {
    for (const auto& [dx, dy] : four_sides) {
      const int x = column_of(i), y = row_of(i);
      if (has(x + dx, y + dy) && within[index(x + dx, y + dy)]) continue;
      ++outline;
      const int far_x = x + beyond * dx, far_y = y + beyond * dy;
      ground += has(far_x, far_y) && floored[index(far_x, far_y)];
    }
  }
  return 2 * ground > outline;
}

/// Adds floor that lies behind gaps wider than a door, and is open along less than a fifth of its
/// outline: of a square room, four fifths of a side. Niches are open further. Where rooms have
/// ceilings it has one too, unlike a garden behind its fence. The gaps are returned.
std::vector<FloorPlan::Gate> FloorPlan::add_behind_gates(const std::vector<bool>& floor,
                                                         const std::vector<Part>& parts,
                                                         const std::vector<bool>& below_ceiling,
                                                         std::vector<bool>& indoors) const {
  std::vector<bool> left(free_.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = free_[i] && floor[i] && !indoors[i];
  const std::vector<float> clearances = distances_to_others(left);
  const auto is_room = [&](const std::vector<std::size_t>& part) {
    return size_m2(part) >= least_room_m2 && holds_a_robot(part, clearances);
  };
  const std::vector<std::vector<std::size_t>> all = parts_of(left);
  if (std::none_of(all.begin(), all.end(), is_room)) return {};
  std::vector<Gate> gates;
  std::vector<std::size_t> in_rooms;
  for (const Part& part : parts) {
    if (part.enclosure != Enclosure::none) continue;
    in_rooms.insert(in_rooms.end(), part.cells.begin(), part.cells.end());
  }
  const std::vector<bool> rooms = indoors;
  const std::vector<float> closing = closing_gaps_m();
  for (double free_m = widest_gap_m + gap_step_m; free_m <= widest_gate_m; free_m += gap_step_m) {
    std::vector<bool> cells(free_.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
      cells[i] = left[i] && closing[i] <= static_cast<float>(free_m);
    }
    const bool has_ceilings = most_are(in_rooms, below_ceiling);
    for (const std::vector<std::size_t>& part : parts_of(cells)) {
      if (!is_room(part) || !is_walled(part, cells, rooms)) continue;
      std::vector<std::size_t> added;  // to what is enclosed by narrower gaps
      for (const std::size_t i : part) {
        if (!indoors[i]) added.push_back(i);
      }
      if (has_ceilings && !most_are(added, below_ceiling)) continue;
      for (const std::size_t i : added) indoors[i] = true;
      in_rooms.insert(in_rooms.end(), added.begin(), added.end());
      if (2 * added.size() > part.size()) gates.push_back({added[0], gap_into(part, closing)});
    }
  }
  return gates;
}

bool FloorPlan::is_walled(const std::vector<std::size_t>& part,
                          const std::vector<bool>& cells,
                          const std::vector<bool>& indoors) const {
  constexpr std::size_t one_in = 5;  // sides of cells may be open
  std::size_t open = 0, all = 0;
  for (const std::size_t i : part) {
    for (const auto& [dx, dy] : four_sides) {
      const int x = column_of(i) + dx, y = row_of(i) + dy;
      const bool is_beyond = !has(x, y);  // the plan
      const std::size_t next = is_beyond ? i : index(x, y);
      if (!is_beyond && cells[next]) continue;
      ++all;
      open += is_beyond || (free_[next] && !indoors[next]);
    }
  }
  return open * one_in < all;
}

/// For each cell the least diameter, in steps, of discs that do not get to it from the surroundings
/// of the world; infinite if all do.
std::vector<float> FloorPlan::closing_gaps_m() const {
  std::vector<float> closing(free_.size(), std::numeric_limits<float>::infinity());
  const std::vector<float> room_m = distances_to_others(free_, true);
  for (double free_m = widest_gap_m; free_m <= widest_gate_m; free_m += gap_step_m) {
    const std::vector<bool> outside = outdoors(free_m, room_m);
    for (std::size_t i = 0; i < closing.size(); ++i) {
      if (!outside[i]) closing[i] = std::min(closing[i], static_cast<float>(free_m));
    }
  }
  return closing;
}

/// The width of the gap through which the surroundings come into half of some cells, to about
/// 0.3 m; 0 where there are none that keep them out.
double FloorPlan::gap_into(const std::vector<std::size_t>& cells,
                           const std::vector<float>& closing_m) {
  std::vector<float> widths;
  for (const std::size_t i : cells) widths.push_back(closing_m[i]);
  const auto middle = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2);
  std::nth_element(widths.begin(), middle, widths.end());
  // What is free keeps the robot's radius from both posts.
  const double width_m = static_cast<double>(*middle) - gap_step_m / 2 + 2 * robot_radius_m;
  return std::isfinite(width_m) ? width_m : 0;
}

/// What has no floor is a stairwell, an atrium, or lower, unless the file has no floors.
std::vector<bool> FloorPlan::without_floor(const std::vector<bool>& floored,
                                           const std::vector<bool>& indoors,
                                           const std::vector<Part>& parts) const {
  constexpr std::size_t one_in = 10;  // cells with a floor; fewer are mats and sills
  std::vector<bool> bare(indoors.size());
  std::size_t cells = 0, with_floor = 0;
  for (const Part& part : parts) {
    if (part.enclosure == Enclosure::body) continue;
    cells += part.cells.size();
    for (const std::size_t i : part.cells) with_floor += floored[i];
  }
  if (one_in * with_floor <= cells) return bare;
  const std::vector<bool> kept = near(floored);
  for (std::size_t i = 0; i < indoors.size(); ++i) bare[i] = indoors[i] && !kept[i];
  return bare;
}

/// What has no floor, and floor that is a step higher.
std::vector<bool> FloorPlan::other_levels(const World& world, const std::vector<bool>& bare) const {
  constexpr double low_m = 0.02, high_m = 0.2;  // a step, not a seat
  std::vector<bool> levels = over_floor(world, low_m, high_m);
  for (std::size_t i = 0; i < free_.size(); ++i) levels[i] = bare[i] || (levels[i] && !free_[i]);
  return levels;
}

/// How much of some cells is as large as a room and comes so near to the inside.
double FloorPlan::beside_m2(const std::vector<bool>& cells, double within_m) const {
  const auto nearest_m = static_cast<float>(within_m + cell_m / 4);  // whatever is rounded
  std::vector<bool> elsewhere(free_.size());
  for (std::size_t i = 0; i < free_.size(); ++i) elsewhere[i] = !inside_[i];
  const std::vector<float> away = distances_to_others(elsewhere, true);
  const std::vector<float> clearances = distances_to_others(cells);
  double sum_m2 = 0;
  for (const std::vector<std::size_t>& part : parts_of(cells)) {
    if (size_m2(part) < least_room_m2) break;
    const bool is_beside =
        std::any_of(part.begin(), part.end(), [&](std::size_t i) { return away[i] <= nearest_m; });
    if (is_beside && holds_a_robot(part, clearances)) sum_m2 += size_m2(part);
  }
  return sum_m2;
}

/// What has a floor, or lies by it: the floors of two rooms may leave a gap below the wall between
/// them, also in its door.
std::vector<bool> FloorPlan::near(const std::vector<bool>& floored) const {
  constexpr float gap_m = 0.25f;  // half of a thick wall
  std::vector<bool> is_near(floored.size());
  for (std::size_t i = 0; i < floored.size(); ++i) is_near[i] = !floored[i];
  const std::vector<float> away = distances_to_others(is_near, true);
  for (std::size_t i = 0; i < floored.size(); ++i) is_near[i] = away[i] <= gap_m;
  return is_near;
}

}  // namespace vernier::sim::internal
