// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/views/depth_steps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/image/depth_image.h"

namespace vernier::localise::internal {

using stereo::EdgePoint;
using stereo::internal::DepthImage;

namespace {

constexpr int near_px = 2;
constexpr float least_step = 0.1F;  // of the nearer depth

std::vector<bool> near_edges(const std::vector<EdgePoint>& edges, int width_px, int height_px) {
  std::vector<bool> is_near(static_cast<std::size_t>(width_px) * height_px, false);
  for (const EdgePoint& e : edges) {
    const auto x = static_cast<int>(std::lround(e.pixel_px.x()));
    const auto y = static_cast<int>(std::lround(e.pixel_px.y()));
    for (int v = std::max(0, y - near_px); v <= std::min(height_px - 1, y + near_px); ++v) {
      for (int u = std::max(0, x - near_px); u <= std::min(width_px - 1, x + near_px); ++u) {
        is_near[static_cast<std::size_t>(v) * width_px + u] = true;
      }
    }
  }
  return is_near;
}

bool is_step(float a_m, float b_m) {
  return a_m > 0 && b_m > 0 && std::abs(a_m - b_m) > least_step * std::min(a_m, b_m);
}

}  // namespace

StepsAtEdges steps_at_edges(const std::vector<EdgePoint>& edges, const DepthImage& depth) {
  const int width = depth.width_px, height = depth.height_px;
  const std::vector<bool> is_near = near_edges(edges, width, height);
  StepsAtEdges found;
  int at_edges = 0;
  for (int y = 1; y + 1 < height; ++y) {
    for (int x = 1; x + 1 < width; ++x) {
      if (!is_step(depth(x - 1, y), depth(x + 1, y)) &&
          !is_step(depth(x, y - 1), depth(x, y + 1))) {
        continue;
      }
      ++found.steps;
      at_edges += is_near[static_cast<std::size_t>(y) * width + x] ? 1 : 0;
    }
  }
  if (found.steps > 0) found.at_edges = static_cast<double>(at_edges) / found.steps;
  if (!is_near.empty()) {
    found.by_chance = static_cast<double>(std::count(is_near.begin(), is_near.end(), true)) /
                      static_cast<double>(is_near.size());
  }
  return found;
}

}  // namespace vernier::localise::internal
