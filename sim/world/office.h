// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "sim/world.h"

namespace vernier::sim::internal {

/// How an office floor is laid out.
struct OfficeOptions {
  Eigen::Vector3d size_m{20, 15, 2.5};  ///< outer length, width and height
  double corridor_width_m = 1.8;
  double room_width_m = 4.0;  ///< aimed at; rooms divide the length evenly
};

/// An office floor by seed: a corridor along x with rooms on both sides. Door frames, windows,
/// radiators, lights, desks, chairs, shelves, cupboards, notice boards are templates placed many
/// times; each room draws its own arrangement and its own odds and ends (loose books, boxes,
/// pictures, cables), as rooms of real offices do. The same seed and options give the same
/// description to the bit. Throws Error for a size in which no room fits.
WorldDescription make_office(std::uint64_t seed, const OfficeOptions& options = {});

}  // namespace vernier::sim::internal
