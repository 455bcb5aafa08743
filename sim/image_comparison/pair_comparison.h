// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/image_comparison/edge_sample.h"
#include "sim/image_comparison/explained_points.h"
#include "sim/images/rendered_pair.h"
#include "sim/images/true_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"

namespace vernier::sim::internal {

struct PairComparisonOptions {
  ExplainOptions explain;
  double min_length_px = 10;      ///< of segments, as in the simulator
  double end_px = 3;              ///< an end farther off along the edge is not the same end
  int min_points = 8;             ///< of an edge, for its shift
  double min_angle_rad = 0.0873;  ///< of edges that matchers are asked for (5°)
  double contrast_reach_px = 3;   ///< grey levels are compared within this distance of an edge
};

/// Finds edges and segments in both rectified images, matches the left image's edge points, and
/// adds what became of every true edge, and what no edge explains. Definitions: docs/images.md.
void add_pair(const RenderedPair& pair,
              const TrueEdges& truth,
              const stereo::DisparityRange& range,
              const std::vector<stereo::Matcher>& matchers,
              ComparedEdges& compared,
              const PairComparisonOptions& options = {});

}  // namespace vernier::sim::internal
