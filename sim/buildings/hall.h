// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "sim/buildings/space.h"
#include "sim/world.h"

namespace vernier::sim::internal {

/// Outline of a hall.
struct HallOptions {
  Eigen::Vector3d size_m{40, 25, 6};  ///< inner length, width and height
  OpenEnds open;
};

/// Generates a storage and production hall from a seed: columns and beams, rows along x of pallet
/// racks, machines or pallets on the floor with aisles between them, gates, high windows, benches
/// and cabinets along the walls. The route goes around the rows, through every aisle and to the
/// open ends. The same seed and options give the same description to the bit. Throws Error for a
/// size that is out of range.
WorldDescription make_hall(std::uint64_t seed, const HallOptions& options = {});

}  // namespace vernier::sim::internal
