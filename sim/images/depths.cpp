// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/depths.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "calib/base/ordered_parallel.h"
#include "calib/camera.h"
#include "calib/pose.h"
#include "sim/images/image_scene.h"
#include "sim/images/ray_scene.h"
#include "sim/images/render.h"
#include "sim/images/tracer.h"

namespace vernier::sim::internal {

using Eigen::Vector2d;

namespace {

constexpr double no_depth = std::numeric_limits<double>::quiet_NaN();

/// Of at most bundle_size rays.
void depths_of_bundle(const Eye& eye, Tracer& tracer, const Vector2d* rays, int count, double* z) {
  std::array<SeenSurface, bundle_size> seen;
  tracer.trace(eye.bundle(rays, count), seen);
  for (int i = 0; i < count; ++i) {
    const SeenSurface& at = seen[static_cast<std::size_t>(i)];
    z[i] = at.face == no_face ? no_depth : depth_of(eye, at, eye.direction(rays[i]));
  }
}

void depths_of_row(const Eye& eye, const Camera& camera, int row, double* depths) {
  Tracer tracer(eye);
  std::array<Vector2d, bundle_size> rays;
  for (int from = 0; from < camera.size_px[0]; from += bundle_size) {
    const int count = std::min(bundle_size, camera.size_px[0] - from);
    for (int i = 0; i < count; ++i) {
      const auto ray = try_unproject(camera, Vector2d(from + i, row));
      rays[static_cast<std::size_t>(i)] =
          ray ? Vector2d(ray->head<2>()) : Vector2d(no_depth, no_depth);
    }
    depths_of_bundle(eye, tracer, rays.data(), count, depths + from);
  }
}

}  // namespace

std::vector<double> depths_m(const ImageScene& scene,
                             const Camera& camera,
                             const Pose& T_camera_world,
                             int threads) {
  check_image_size(camera);
  const auto width = static_cast<std::size_t>(camera.size_px[0]);
  const auto height = static_cast<std::size_t>(camera.size_px[1]);
  std::vector<double> depths(width * height);
  const Eye eye(scene, T_camera_world);
  vernier::internal::for_each_index(height, threads, [&](std::size_t row) {
    depths_of_row(eye, camera, static_cast<int>(row), &depths[row * width]);
  });
  return depths;
}

std::vector<double> depths_along(const ImageScene& scene,
                                 const Pose& T_camera_world,
                                 const std::vector<Vector2d>& rays,
                                 int threads) {
  std::vector<double> depths(rays.size());
  const Eye eye(scene, T_camera_world);
  constexpr std::size_t many = bundle_size;
  const std::size_t bundles = (rays.size() + many - 1) / many;
  vernier::internal::for_each_index(bundles, threads, [&](std::size_t bundle) {
    const std::size_t from = bundle * many;
    const int count = static_cast<int>(std::min(many, rays.size() - from));
    Tracer tracer(eye);
    depths_of_bundle(eye, tracer, &rays[from], count, &depths[from]);
  });
  return depths;
}

}  // namespace vernier::sim::internal
