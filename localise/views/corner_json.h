// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "calib/base/json_node.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "localise/views/view_json.h"

namespace vernier::localise::internal {

/// [{"left_px": [u, v], "right_px": [u, v], "covariance_px2": [[…]…], "descriptor": […]}, …]
Json corners_json(std::span<const StereoCorner> corners);

/// `descriptor` may be missing in all corners, `covariance_px2` in any (0.09 px² each). `rig` is
/// that which saw them. Throws Error for null, and corners that are none (read_views()).
std::vector<StereoCorner> parse_corners(const vernier::internal::JsonNode& node, const Rig* rig);

}  // namespace vernier::localise::internal
