// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/map_window.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "calib/error.h"
#include "stereo/canny_edges.h"
#include "stereo/disparity_file.h"

namespace vernier::stereo::internal {
namespace {

/// Whether there is a discontinuity along a line of `count` pixels from (x, y) in direction (dx,
/// dy).
bool line_has_step(const DisparityMap& map, int x, int y, int dx, int dy, int count) {
  int last = -1;
  float before = 0;
  for (int i = 0; i < count; ++i, x += dx, y += dy) {
    if (!map.known(x, y)) continue;
    const auto apart = static_cast<float>(i - last);
    if (last >= 0 && std::abs(map(x, y) - before) > apart * step_px) return true;
    last = i;
    before = map(x, y);
  }
  return false;
}

}  // namespace

MapWindow::MapWindow(const DisparityMap& of, int x, int y, int half)
    : map(of),
      x0(std::max(x - half, 0)),
      y0(std::max(y - half, 0)),
      x1(std::min(x + half, of.width_px - 1)),
      y1(std::min(y + half, of.height_px - 1)) {}

bool MapWindow::has_step() const {
  for (int y = y0; y <= y1; ++y) {
    if (line_has_step(map, x0, y, 1, 0, x1 - x0 + 1)) return true;
  }
  for (int x = x0; x <= x1; ++x) {
    if (line_has_step(map, x, y0, 0, 1, y1 - y0 + 1)) return true;
  }
  return false;
}

int column_of(const EdgePoint& edge, const DisparityMap& map, const std::string& place) {
  if (edge.x < 0 || edge.y < 0 || edge.x >= map.width_px || edge.y >= map.height_px) {
    throw Error(place,
                fmt::format("has {}x{} pixels, but an edge is at ({}, {})", map.width_px,
                            map.height_px, edge.x, edge.y),
                "use the map and the edges of one image");
  }
  return std::clamp(static_cast<int>(std::lround(edge.row_x_px)), 0, map.width_px - 1);
}

float along_row(const DisparityMap& map, float x, int y) {
  const float inside = std::clamp(x, 0.0f, static_cast<float>(map.width_px - 1));
  const int first = static_cast<int>(inside), second = std::min(first + 1, map.width_px - 1);
  if (!map.known(first, y)) return map(second, y);
  if (!map.known(second, y)) return map(first, y);
  const float part = inside - static_cast<float>(first);
  return (1 - part) * map(first, y) + part * map(second, y);
}

void check_known(const DisparityMap& map, const std::string& place) {
  if (std::all_of(map.values.begin(), map.values.end(), [](float d) { return std::isnan(d); })) {
    throw Error(place, "has no known disparity", "check the map");
  }
}

}  // namespace vernier::stereo::internal
