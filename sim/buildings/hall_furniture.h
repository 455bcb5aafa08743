// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sim/world.h"

namespace vernier::sim::internal {

inline constexpr double bay_width_m = 2.8, bay_depth_m = 1.1;
/// Upper sides of what pallets stand on in a bay; the first is the floor.
inline constexpr double bay_levels_m[] = {0, 1.5, 2.9};

/// Templates of halls, with origins as those of office_templates(): pallet loads at their near left
/// corner, machines at their back, strip lights and beams at the ceiling. Machines, and what stands
/// on pallets, are drawn from the seed; columns and beams have the height and the width of the
/// hall.
std::vector<WorldTemplate> hall_templates(std::uint64_t seed, double width_m, double height_m);

}  // namespace vernier::sim::internal
