// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/right_edges.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matching/stretch_correlation.h"

namespace vernier::stereo::internal {

RightEdges::RightEdges(const GreyLevels& right, const StretchOptions& options)
    : reach_px_(static_cast<float>(options.edge_reach_px)),
      max_ratio_(static_cast<float>(options.max_contrast_ratio)),
      min_cosine_(static_cast<float>(std::cos(options.max_turn_rad))),
      width_(right.width_px),
      height_(right.height_px) {
  // Edges rotate a little between views; horizontal edges do not cross their row.
  const auto min_sine = static_cast<float>(std::sin(0.5 * options.min_angle_rad));
  const std::vector<EdgePoint> edges = canny_edges(right, options.right_edges);
  crossings_.reserve(edges.size());
  from_pixel_.resize(static_cast<std::size_t>(width_ + 1) * static_cast<std::size_t>(height_));
  int* from = from_pixel_.data();
  auto edge = edges.begin();
  for (int y = 0; y < height_; ++y) {
    int x = 0;
    for (; edge != edges.end() && edge->y == y; ++edge) {
      if (std::abs(edge->normal.x()) < min_sine) continue;
      for (; x <= edge->x; ++x) *from++ = static_cast<int>(crossings_.size());
      crossings_.push_back({edge->row_x_px, edge->pixel_px.x(), edge->pixel_px.y(),
                            -edge->normal.y() / edge->normal.x(), edge->normal, edge->strength});
    }
    for (; x <= width_; ++x) *from++ = static_cast<int>(crossings_.size());
  }
}

bool RightEdges::is_like(const EdgePoint& left, const Crossing& right) const {
  return left.normal.x() * right.normal.x() > 0 && left.normal.dot(right.normal) >= min_cosine_ &&
         right.strength <= max_ratio_ * left.strength &&
         left.strength <= max_ratio_ * right.strength;
}

float RightEdges::nearest_px(const EdgePoint& left, float x_px) const {
  constexpr float from_pixel_px = 1.5f;  // maximum distance of an edge from its pixel along its row
  const float reach = reach_px_ + from_pixel_px;
  const auto column = [&](float x) {
    return static_cast<int>(std::clamp(x, 0.0f, static_cast<float>(width_)));
  };
  const int first = column(x_px - reach + 1), end = column(x_px + reach + 1);
  float least = reach_px_, nearest = std::numeric_limits<float>::quiet_NaN();
  for (int y = std::max(0, left.y - 1); y <= std::min(height_ - 1, left.y + 1); ++y) {
    const int* const row =
        from_pixel_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ + 1);
    for (int k = row[first]; k < row[end]; ++k) {
      const Crossing& edge = crossings_[static_cast<std::size_t>(k)];
      const float down = static_cast<float>(left.y) - edge.place_y_px;
      const float at = y == left.y ? edge.x_px : edge.place_x_px + down * edge.slope;
      const float off = std::abs(at - x_px);
      if (off > least || (off == least && !std::isnan(nearest)) || !is_like(left, edge)) continue;
      least = off;
      nearest = at;
    }
  }
  return nearest;
}

}  // namespace vernier::stereo::internal
