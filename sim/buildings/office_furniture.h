// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "sim/world.h"

namespace vernier::sim::internal {

inline constexpr double wall_thickness_m = 0.1;
inline constexpr double door_width_m = 0.9;
inline constexpr double door_height_m = 2.05;
inline constexpr double casing_m = 0.08;     ///< width of the door frame's face
inline constexpr double board_top_m = 0.74;  ///< height of a desk top

/// The bookshelf, for placing books: upper sides of its boards, clear width and height between
/// boards, its side panels and the distance of the books from the wall.
inline constexpr std::array<double, 5> shelf_boards_m{0.08, 0.46, 0.84, 1.22, 1.60};
inline constexpr double shelf_side_m = 0.03, shelf_clear_m = 0.84;
inline constexpr double shelf_clear_height_m = 0.35, book_front_m = 0.28;

/// Office templates. Standing and wall-mounted objects have their origin at the wall, x along the
/// wall, y into the room, z up from the floor; ceiling lights and vents at their centre in the
/// ceiling; chairs, monitors and bins at their centre on the surface below; door frames at the
/// centre of the opening on the room's side of the wall.
std::vector<WorldTemplate> office_templates();

}  // namespace vernier::sim::internal
