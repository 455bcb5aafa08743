// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/right_edges.h"

#include <algorithm>
#include <cmath>

namespace vernier {
namespace {

/// Where an edge crosses a row, in a straight line through its place.
float crossing_px(const EdgePoint& edge, int y) {
  if (edge.y == y) return edge.row_x_px;
  return edge.pixel_px.x() -
         (static_cast<float>(y) - edge.pixel_px.y()) * edge.normal.y() / edge.normal.x();
}

}  // namespace

RightEdges::RightEdges(const GreyLevels& right, const StretchOptions& options)
    : options_(options),
      least_sine_(static_cast<float>(std::sin(0.5 * options.least_angle_rad))),
      least_cosine_(static_cast<float>(std::cos(options.most_turn_rad))),
      width_(right.width_px),
      height_(right.height_px),
      edges_(canny_edges(right, options.right_edges)),
      at_pixel_(right.values.size(), -1) {
  for (std::size_t k = 0; k < edges_.size(); ++k) {
    const EdgePoint& edge = edges_[k];
    if (std::abs(edge.normal.x()) < least_sine_) continue;
    at_pixel_[static_cast<std::size_t>(edge.y) * static_cast<std::size_t>(width_) +
              static_cast<std::size_t>(edge.x)] = static_cast<int>(k);
  }
}

bool RightEdges::is_like(const EdgePoint& left, const EdgePoint& right) const {
  const auto most = static_cast<float>(options_.most_contrast_ratio);
  return left.normal.x() * right.normal.x() > 0 && left.normal.dot(right.normal) >= least_cosine_ &&
         right.strength <= most * left.strength && left.strength <= most * right.strength;
}

float RightEdges::nearest_px(const EdgePoint& left, float x_px) const {
  constexpr float from_pixel_px = 1.5f;  // that an edge is within in its row
  const auto reach = static_cast<float>(options_.edge_reach_px);
  const auto column = [&](float x) {
    return std::clamp(static_cast<int>(std::lround(x)), 0, width_ - 1);
  };
  const int first = column(x_px - reach - from_pixel_px);
  const int last = column(x_px + reach + from_pixel_px);
  float least = reach, nearest = std::numeric_limits<float>::quiet_NaN();
  for (int y = std::max(0, left.y - 1); y <= std::min(height_ - 1, left.y + 1); ++y) {
    const int* const row =
        at_pixel_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    for (int x = first; x <= last; ++x) {
      if (row[x] < 0) continue;
      const EdgePoint& edge = edges_[static_cast<std::size_t>(row[x])];
      const float at = crossing_px(edge, left.y);
      const float off = std::abs(at - x_px);
      if (off > least || !is_like(left, edge)) continue;
      if (off == least && at != nearest) continue;
      least = off;
      nearest = at;
    }
  }
  return nearest;
}

}  // namespace vernier
