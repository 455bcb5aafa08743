// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::sim {

/// Whether the instances of a template belong to the building and stay where they are, by its name:
/// door_frame, door_leaf_left, door_leaf_right, door_sign, window, radiator, ceiling_light,
/// ceiling_vent, notice_board, whiteboard, socket and light_switch, as in generated offices.
bool is_fixture(std::string_view template_name);

/// Whether a world has objects that with_moved_furniture may move.
bool has_furniture(const World& world);

/// The world after a share of its furniture has been moved: every object but the loose features and
/// the fixtures moves with probability `share`, by 0.3 to 1 m in any direction along the floor, and
/// is turned by up to ± 0.8 rad about its own middle, both uniform. Through walls and each other,
/// for all that is known. Keyed by the object: a larger share moves a superset, and those alike.
/// Numbers of segments, surfaces, corners and objects stay.
World with_moved_furniture(const World& world, double share, std::uint64_t seed);

/// The world as queries find it after the map was recorded.
struct ChangedWorld {
  ChangedWorld(const World& recorded, double share, std::uint64_t seed)
      : world(with_moved_furniture(recorded, share, seed)), visibility(world) {}
  ChangedWorld(const ChangedWorld&) = delete;
  ChangedWorld& operator=(const ChangedWorld&) = delete;

  const World world;
  const Visibility visibility;  ///< of `world`
};

}  // namespace vernier::sim
