// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "sim/buildings/space.h"
#include "sim/world.h"

namespace vernier::sim::internal {

/// Outline of a floor of homes.
struct HomeOptions {
  Eigen::Vector3d size_m{12, 10, 2.6};  ///< outer length, width and height
  OpenEnds open;
};

/// Generates a home from a seed: the floor is cut again and again, across its longer side, until
/// rooms have 8 to 22 m². Doors make a tree that reaches every room, and some more. The largest
/// room is the living room, the next a kitchen, the smallest are bathrooms, the others bedrooms,
/// studies or living rooms; each is furnished with what such rooms hold. The route has a leg for
/// each door, from the middle of one room to that of the other. The same seed and options give the
/// same description to the bit. Throws Error for a size that is out of range.
WorldDescription make_home(std::uint64_t seed, const HomeOptions& options = {});

}  // namespace vernier::sim::internal
