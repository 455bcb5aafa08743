// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/tracer.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "sim/images/image_scene.h"
#include "sim/images/ray_scene.h"

namespace vernier::sim::internal {

using Eigen::Vector3d;
using Eigen::Vector3f;

void Tracer::trace(const RayBundle& rays, std::array<SeenSurface, bundle_size>& seen) {
  constexpr float slack_m = 0.01F;
  const ImageScene& scene = eye_.scene();
  scene.solids.nearest(rays, hits_);
  std::array<float, bundle_size> farthest{};
  for (int i = 0; i < rays.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const bool hit = hits_.triangle[k] != no_triangle;
    seen[k].face = hit ? scene.face_of_triangle[hits_.triangle[k]] : no_face;
    seen[k].figure_count = 0;
    // A figure in the plane of its face may be hit a little behind it.
    if (hit) farthest[k] = 1.001F * hits_.distance[k] + slack_m;
  }
  scene.paint.crossings(rays, farthest, crossings_);
  for (int i = 0; i < rays.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (seen[k].face != no_face && crossings_.count[k] > 0) {
      add_figures(k, Vector3f(rays.x[k], rays.y[k], rays.z[k]), seen[k]);
    }
  }
}

void Tracer::add_figures(std::size_t ray, const Vector3f& direction, SeenSurface& seen) const {
  constexpr double in_front_m = 0.03, behind_m = 1e-3;
  const ImageScene& scene = eye_.scene();
  for (int c = 0; c < crossings_.count[ray]; ++c) {
    const auto at = static_cast<std::size_t>(c);
    const int figure = scene.figure_of_triangle[crossings_.triangle[ray][at]];
    const PaintPlane& plane = scene.figures[static_cast<std::size_t>(figure)];
    const double before = (hits_.distance[ray] - crossings_.distance[ray][at]) *
                          std::abs(plane.normal.cast<float>().dot(direction));
    if (before > in_front_m || before < -behind_m) continue;
    int* const end = seen.figures.data() + seen.figure_count;
    int* const place = std::lower_bound(seen.figures.data(), end, figure);
    if (place != end && *place == figure) continue;
    std::copy_backward(place, end, end + 1);
    *place = figure;
    ++seen.figure_count;
  }
}

double depth_of(const Eye& eye, const SeenSurface& seen, const Vector3d& direction) {
  const ImageScene& scene = eye.scene();
  const PaintPlane* smallest = nullptr;
  for (int i = 0; i < seen.figure_count; ++i) {
    const auto figure = static_cast<std::size_t>(seen.figures[static_cast<std::size_t>(i)]);
    const PaintPlane& plane = scene.figures[figure];
    if (smallest == nullptr || plane.area_m2 < smallest->area_m2) smallest = &plane;
  }
  if (smallest != nullptr) return eye.depth(*smallest, direction);
  return eye.depth(scene.faces[static_cast<std::size_t>(seen.face)], direction);
}

}  // namespace vernier::sim::internal
