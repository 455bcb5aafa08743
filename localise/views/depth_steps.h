// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/image/depth_image.h"

namespace vernier::localise::internal {

/// How the steps of a depth map lie to the edges of its image. Where one surface ends before
/// another the image has an edge, nearly always; the steps of another image's map lie anywhere.
struct StepsAtEdges {
  int steps = 0;         ///< pixels whose neighbours' depths differ by a tenth
  double at_edges = 0;   ///< share of them within 2 px of an edge
  double by_chance = 0;  ///< share of all pixels within 2 px of an edge
};

/// Both are of one size.
StepsAtEdges steps_at_edges(const std::vector<stereo::EdgePoint>& edges,
                            const stereo::internal::DepthImage& depth);

}  // namespace vernier::localise::internal
