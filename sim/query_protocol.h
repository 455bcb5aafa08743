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

/// How far from the recorded route queries are asked. Worth more than any other setting, so it is
/// part of every result.
enum class QueryProtocol {
  near_path,  ///< ± 0.1 m across the route, ± 5°
  path,       ///< ± 0.3 m, ± 15°
  anywhere,   ///< ± 0.6 m, any heading
};

std::string_view name(QueryProtocol protocol);
/// Throws Error for a name that is none of near_path, path, anywhere.
QueryProtocol query_protocol(std::string_view name);

/// Half the span across the route (metres) and of heading (radians).
struct ProtocolSpan {
  double across_m, heading_rad;
};
ProtocolSpan span(QueryProtocol protocol);

/// Whether a robot of the given radius can stand at a point: no surface lower than `height_m` comes
/// nearer than the radius.
bool is_free(const World& world, const Eigen::Vector2d& at_m, double radius_m, double height_m);

/// Why a robot's camera cannot be at a pose, as the rest of a sentence that the pose begins; empty
/// where it can. It cannot outside the box of the world's segments and surfaces and of 0.6 m about
/// its route; below the floor; above a level surface over the place, such as a ceiling; where a
/// robot of 0.12 m radius that rises 0.2 m above its camera could not stand; and, in a world with a
/// route, in a space that surfaces at the camera's height close off from the route (the inside of a
/// wall or of a cupboard).
std::string standing_fault(const Visibility& visibility,
                           const localise::Pose2D& pose,
                           double eye_height_m);

/// Where trial `trial` asks: uniform along the route, across it and in heading; drawn again (from
/// the same stream) where a robot of 0.12 m radius could not stand or a surface parts the place
/// from the route. Throws Error where 1000 draws find no place.
localise::Pose2D draw_query(const Visibility& visibility,
                            QueryProtocol protocol,
                            double eye_height_m,
                            std::uint64_t seed,
                            std::uint32_t trial);

}  // namespace vernier::sim
