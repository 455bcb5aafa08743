// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "localise/place.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::sim {

/// How far from the recorded route queries are drawn. It affects results more than any other
/// setting and is part of every result.
enum class QueryProtocol {
  near_path,  ///< ± 0.1 m across the route, ± 5°
  path,       ///< ± 0.3 m, ± 15°
  anywhere,   ///< ± 0.6 m, any heading
};

std::string_view name(QueryProtocol protocol);
/// Throws Error for a name other than near_path, path, anywhere.
QueryProtocol query_protocol(std::string_view name);

/// Half the range across the route (metres) and of heading (radians).
struct ProtocolSpan {
  double across_m, heading_rad;
};
ProtocolSpan span(QueryProtocol protocol);

/// Whether a robot of the given radius can stand at a point: no surface below `height_m` is closer
/// than the radius.
bool is_free(const World& world, const Eigen::Vector2d& at_m, double radius_m, double height_m);

/// Why a robot's camera cannot be at a pose, as a predicate for a sentence about the pose; empty if
/// it can. It cannot be outside the bounding box of the world's segments and surfaces and of 0.6 m
/// around its route; below the floor; above a level surface over the point, such as a ceiling; where
/// a robot of 0.12 m radius that extends 0.2 m above its camera could not stand; and, in a world
/// with a route, in a space that surfaces at the camera's height close off from the route (the
/// inside of a wall or a cupboard).
std::string standing_fault(const Visibility& visibility,
                           const localise::Pose2D& pose,
                           double eye_height_m);

/// Pose of query `trial`: uniform along the route, across it and in heading; drawn again (from the
/// same stream) where a robot of 0.12 m radius could not stand or a surface separates the position
/// from the route. Throws Error after 1000 draws without success.
localise::Pose2D draw_query(const Visibility& visibility,
                            QueryProtocol protocol,
                            double eye_height_m,
                            std::uint64_t seed,
                            std::uint32_t trial);

}  // namespace vernier::sim
