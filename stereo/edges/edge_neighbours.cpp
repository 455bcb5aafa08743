// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/edges/edge_neighbours.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "stereo/canny_edges.h"

namespace vernier::stereo::internal {

EdgeNeighbours::EdgeNeighbours(const std::vector<EdgePoint>& points) : points_(points) {
  const int rows = points.empty() ? 0 : points.back().y + 1;
  row_begin_.assign(static_cast<std::size_t>(rows) + 1, 0);
  for (const EdgePoint& point : points) ++row_begin_[static_cast<std::size_t>(point.y) + 1];
  for (std::size_t y = 1; y < row_begin_.size(); ++y) row_begin_[y] += row_begin_[y - 1];
}

EdgeNeighbour EdgeNeighbours::nearest(const EdgePlace& place, const EdgeGate& gate) const {
  const double reach = std::hypot(gate.across_px, gate.along_px) + 1;
  const double min_cosine = std::cos(gate.turned_rad);
  const Eigen::Vector2d along(-place.normal.y(), place.normal.x());
  const int rows = static_cast<int>(row_begin_.size()) - 1;
  const int y0 = std::max(0, static_cast<int>(std::floor(place.at_px.y() - reach)));
  const int y1 = std::min(rows - 1, static_cast<int>(std::ceil(place.at_px.y() + reach)));
  std::vector<EdgeNeighbour> in_gate;
  EdgeNeighbour best;
  for (int y = y0; y <= y1; ++y) {
    const auto begin = points_.begin() + row_begin_[static_cast<std::size_t>(y)];
    const auto end = points_.begin() + row_begin_[static_cast<std::size_t>(y) + 1];
    auto point = std::lower_bound(begin, end, place.at_px.x() - reach,
                                  [](const EdgePoint& p, double x) { return p.x < x; });
    for (; point != end && point->x <= place.at_px.x() + reach; ++point) {
      if (point->normal.cast<double>().dot(place.normal) < min_cosine) continue;
      const Eigen::Vector2d apart = point->pixel_px.cast<double>() - place.at_px;
      const double across = place.normal.dot(apart);
      if (std::abs(across) > gate.across_px || std::abs(along.dot(apart)) > gate.along_px) continue;
      in_gate.push_back({static_cast<int>(point - points_.begin()), across});
      if (best.point < 0 || std::abs(across) < std::abs(best.across_px)) best = in_gate.back();
    }
  }
  if (best.point < 0) return best;
  return {best.point, edge_across(in_gate, best)};
}

double EdgeNeighbours::edge_across(const std::vector<EdgeNeighbour>& in_gate,
                                   const EdgeNeighbour& best) const {
  const int string = points_[static_cast<std::size_t>(best.point)].string;
  double sum = 0;
  int count = 0;
  for (const EdgeNeighbour& other : in_gate) {
    if (points_[static_cast<std::size_t>(other.point)].string != string) continue;
    if (std::abs(other.across_px - best.across_px) > 1) continue;
    sum += other.across_px;
    ++count;
  }
  return sum / count;
}

}  // namespace vernier::stereo::internal
