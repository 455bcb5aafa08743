// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/buildings/building_site.h"
#include "sim/buildings/space.h"

namespace vernier::sim::internal {

enum class HomeRoomUse { living, kitchen, bedroom, bathroom, study };

/// A wall of a room of a home.
struct HomeWall {
  RoomWall wall;
  bool is_outer = false;
  std::vector<Opening> openings;
};

/// Furnishes the current room of the site: windows in outer walls, then what its use asks for, each
/// piece at a drawn place of a drawn wall where it fits, then what its use makes likely, pictures,
/// sockets and lights.
void furnish_home_room(BuildingSite& site, HomeRoomUse use, const std::vector<HomeWall>& walls);

}  // namespace vernier::sim::internal
