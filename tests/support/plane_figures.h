// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/matcher.h"
#include "tests/support/leaf_pair.h"

namespace vernier::test {

using namespace vernier::stereo;

/// Edges well inside the right image: the share of them matched, and of these more than 3 px wrong.
struct PlaneFigures {
  double density = 0, mismatch = 0;
};

inline PlaneFigures figures(const LeafPlane& plane,
                            const std::vector<EdgePoint>& edges,
                            const std::vector<EdgeDisparity>& found) {
  int asked = 0, matched = 0, wrong = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const double x = edges[i].row_x_px, truth = plane.disparity_at(x, edges[i].y);
    if (std::abs(edges[i].normal.x()) < 0.0872f || truth < 0) continue;
    if (x - truth < 20 || x - truth > plane.width_px - 20) continue;
    ++asked;
    if (!found[i].matched()) continue;
    ++matched;
    wrong += std::abs(found[i].disparity_px - truth) > 3 ? 1 : 0;
  }
  return {static_cast<double>(matched) / asked, static_cast<double>(wrong) / matched};
}

}  // namespace vernier::test
