// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace vernier::sim::internal {

/// Largest sizes of a world, checked where a world is read and where it is built
/// (docs/robustness.md has the reasons).

/// Of a coordinate. A double resolves 2e-12 m there, far below the 1e-9 m within which the
/// visibility counts a point as on a border.
inline constexpr double largest_coordinate_m = 10'000;

/// Of segments, of corners, of surfaces and of objects each, templates instantiated.
inline constexpr std::size_t most_features = 1'000'000;

/// Of one surface: splitting it into convex pieces takes up to the cube of them.
inline constexpr std::size_t most_polygon_points = 200;

/// Of all legs of the route.
inline constexpr std::size_t most_route_points = 100'000;
inline constexpr double longest_route_m = 100'000;

/// Views along the route in a map: nodes times headings.
inline constexpr std::size_t most_map_views = 100'000;

}  // namespace vernier::sim::internal
