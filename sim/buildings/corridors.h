// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "sim/buildings/space.h"
#include "sim/world.h"

namespace vernier::sim::internal {

/// Outline of a net of corridors.
struct CorridorOptions {
  Eigen::Vector3d size_m{30, 20, 2.6};  ///< outer length, width and height
  OpenEnds open;
};

/// Generates a net of corridors from a seed, as in hospitals and hotels: some along x, one of them
/// in the middle from end to end, others across, with closed doors at even distances, and what
/// hangs and stands between them. Little tells its places apart. The route follows the middle of
/// every corridor. The same seed and options give the same description to the bit. Throws Error for
/// a size that is out of range.
WorldDescription make_corridors(std::uint64_t seed, const CorridorOptions& options = {});

}  // namespace vernier::sim::internal
