// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/buildings/building_site.h"

namespace vernier::sim::internal {

/// Furnishes the current room of the site: windows and radiators at the wall `window_side`,
/// randomly drawn furniture along all walls, lights and vents. The door is in the opposite wall,
/// with its centre at `door_x_m` along that wall; the space around it stays free.
void furnish_room(BuildingSite& site, int window_side, double door_x_m);

}  // namespace vernier::sim::internal
