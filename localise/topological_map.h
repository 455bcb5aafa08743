// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "localise/pgh.h"
#include "localise/place.h"

namespace vernier::localise {

/// A map node: the pose where it was recorded and the view from there.
struct MapNode {
  Pose2D pose;
  PlaceView view;
};

/// Views recorded along a route, with the histograms of their lines.
struct TopologicalMap {
  std::vector<MapNode> nodes;
  PghOptions options;           ///< queries must use the same options
  std::vector<Pgh> histograms;  ///< one per node
};

/// Computes the spatial histograms of every node.
TopologicalMap make_map(std::vector<MapNode> nodes, const PghOptions& options = {});

}  // namespace vernier::localise
