// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "localise/place.h"

namespace vernier::localise {

/// A map node: the pose where it was recorded and the view from there.
struct MapNode {
  Pose2D pose;
  PlaceView view;
};

/// Views recorded along a route, in one world frame. A map is extended by adding nodes.
struct TopologicalMap {
  std::vector<MapNode> nodes;
};

}  // namespace vernier::localise
