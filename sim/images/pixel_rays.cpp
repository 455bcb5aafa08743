// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/pixel_rays.h"

#include <cstddef>
#include <limits>

#include "calib/camera.h"

namespace vernier::sim::internal {

using Eigen::Vector2d;

RowRays::RowRays(const Camera& camera, int row) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  for (int side = 0; side < 2; ++side) {
    std::vector<Vector2d>& rays = side == 0 ? above_ : below_;
    rays.reserve(static_cast<std::size_t>(camera.size_px[0]) + 1);
    for (int x = 0; x <= camera.size_px[0]; ++x) {
      const auto ray = try_unproject(camera, {x - 0.5, row + side - 0.5});
      rays.push_back(ray ? Vector2d(ray->head<2>()) : Vector2d(none, none));
    }
  }
}

std::vector<Vector2d> sample_places(int n) {
  std::vector<Vector2d> places;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i)
      places.emplace_back((i + (j + 0.5) / n) / n, (j + (i + 0.5) / n) / n);
  }
  return places;
}

}  // namespace vernier::sim::internal
