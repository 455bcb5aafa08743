// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "localise/pgh.h"
#include "localise/place.h"

namespace vernier::localise {

/// A place on the map: where it was recorded and what was seen from there.
struct MapNode {
  Pose2D pose;
  PlaceView view;
};

/// Views recorded along a path, with the histograms of their lines.
struct TopologicalMap {
  std::vector<MapNode> nodes;
  PghOptions options;           ///< queries must use the same
  std::vector<Pgh> histograms;  ///< one a node
};

/// Computes every node's spatial histograms.
TopologicalMap make_map(std::vector<MapNode> nodes, const PghOptions& options = {});

}  // namespace vernier::localise
