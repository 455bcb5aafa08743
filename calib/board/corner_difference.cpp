// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/corner_difference.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

#include "calib/board_observations.h"

namespace vernier::internal {

CornerDifference corner_difference(const BoardView& a, const BoardView& b, double max_px) {
  std::map<int, Eigen::Vector2d> pixels;
  const bool same_corners = a.ids == b.ids;
  if (!same_corners) {
    for (std::size_t i = 0; i < a.ids.size(); ++i) pixels[a.ids[i]] = a.pixels_px[i];
  }
  const auto most = static_cast<double>(std::min(a.ids.size(), b.ids.size()));
  const double enough = 2 * max_px * max_px * most;
  double largest = 0, sum = 0;
  int shared = 0;
  for (std::size_t i = 0; i < b.ids.size() && sum <= enough; ++i) {
    const auto other = same_corners ? pixels.end() : pixels.find(b.ids[i]);
    if (!same_corners && other == pixels.end()) continue;
    const Eigen::Vector2d d = b.pixels_px[i] - (same_corners ? a.pixels_px[i] : other->second);
    largest = std::max(largest, d.cwiseAbs().maxCoeff());
    sum += d.squaredNorm();
    ++shared;
  }
  if (shared < 4 || sum > enough) return {};
  return {largest, std::sqrt(sum / (2 * shared))};
}

}  // namespace vernier::internal
