// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/edge_sampling.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>

#include "stereo/canny_edges.h"
#include "stereo/disparity_file.h"
#include "stereo/matcher.h"
#include "stereo/matching/map_window.h"

namespace vernier::stereo::internal {
namespace {

/// The largest disparity that two pixels of the window have within a pixel; NaN if no two agree.
float foreground(const MapWindow& window) {
  std::array<float, 9> known{};
  std::size_t count = 0;
  for (int y = window.y0; y <= window.y1; ++y) {
    for (int x = window.x0; x <= window.x1; ++x) {
      if (window.map.known(x, y)) known[count++] = window.map(x, y);
    }
  }
  std::sort(known.begin(), known.begin() + count, std::greater<>());
  for (std::size_t i = 1; i < count; ++i) {
    if (known[i - 1] - known[i] <= step_px) return known[i - 1];
  }
  return std::numeric_limits<float>::quiet_NaN();
}

EdgeDisparity sample(const DisparityMap& map, const EdgePoint& edge, EdgeSampling sampling) {
  const int x = column_of(edge, map, "disparity map");
  EdgeDisparity at;
  if (!map.known(x, edge.y)) return at;
  const MapWindow near(map, x, edge.y, 1);
  if (!near.has_step()) {
    at.disparity_px = along_row(map, edge.row_x_px, edge.y);
  } else {
    at.disparity_px = at.own_px = map(x, edge.y);
    const float nearer = sampling == EdgeSampling::foreground ? foreground(near) : at.own_px;
    if (nearer > at.own_px) at.disparity_px = nearer;
  }
  at.confidence = 1;
  return at;
}

}  // namespace

std::vector<EdgeDisparity> sample_at_edges(const DisparityMap& map,
                                           const std::vector<EdgePoint>& edges,
                                           EdgeSampling sampling) {
  std::vector<EdgeDisparity> disparities;
  disparities.reserve(edges.size());
  for (const EdgePoint& edge : edges) disparities.push_back(sample(map, edge, sampling));
  return disparities;
}

}  // namespace vernier::stereo::internal
