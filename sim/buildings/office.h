// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "sim/buildings/space.h"
#include "sim/world.h"

namespace vernier::sim::internal {

/// Layout of an office floor.
struct OfficeOptions {
  Eigen::Vector3d size_m{20, 15, 2.5};  ///< outer length, width and height
  double corridor_width_m = 1.8;
  double room_width_m = 4.0;  ///< target; rooms divide the length evenly
  OpenEnds open;              ///< doorways at the ends of the corridor
};

/// Generates an office floor from a seed: a corridor along x with rooms on both sides. Door frames,
/// windows, radiators, lights, desks, chairs, shelves, cupboards and notice boards are templates
/// with many instances; each room has its own random arrangement and clutter (loose books, boxes,
/// pictures, cables). The same seed and options give the same description to the bit. Throws Error
/// for a size in which no room fits.
WorldDescription make_office(std::uint64_t seed, const OfficeOptions& options = {});

}  // namespace vernier::sim::internal
