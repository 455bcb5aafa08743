// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/json_node.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "localise/view_file.h"

namespace vernier::localise::internal {

using Json = nlohmann::ordered_json;

/// [x_m, y_m, heading_rad]
Json pose_json(const Pose2D& pose);
/// Throws Error for values beyond 1e6 m or a turn.
Pose2D parse_pose(const vernier::internal::JsonNode& node);

Json view_json(const PlaceView& view);

/// A view, or several under "looks", with their pose if it is known. See read_views().
Json looks_json(std::span<const Look> looks);
RecordedLooks parse_looks(const vernier::internal::JsonNode& node,
                          const std::shared_ptr<const Rig>& rig);

}  // namespace vernier::localise::internal
