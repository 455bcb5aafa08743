// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Cost of a rendered view of the workshop, 640 x 480 px, by part, and of a plain z-buffer of the
// same triangles: one sample a pixel, no lens distortion, nothing painted, flat shading.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig_estimate.h"
#include "datasets/shipped.h"
#include "localise/place.h"
#include "sim/images/depths.h"
#include "sim/images/image_scene.h"
#include "sim/images/image_truth.h"
#include "sim/images/render.h"
#include "sim/images/rendered_pair.h"
#include "sim/noise_free_view.h"
#include "sim/visibility/convex_pieces.h"
#include "sim/world.h"
#include "stereo/rectification.h"

namespace {

using namespace vernier;
using namespace vernier::sim;
using namespace vernier::sim::internal;
using Eigen::Vector2d;
using Eigen::Vector3d;

const World& world() {
  static const World world = build_world(datasets::workshop());
  return world;
}
const ImageScene& scene() {
  static const ImageScene scene = image_scene(world());
  return scene;
}
const Rig& rig() {
  static const Rig rig = datasets::nominal().rig;
  return rig;
}
/// Every benchmark goes through the same places.
Pose place(std::size_t i) {
  static const std::vector<localise::Pose2D> places = map_poses(world().route, 2);
  return T_left_world(places[i % places.size()], {});
}

void make_scene(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(image_scene(world()));
}

void one_eye(benchmark::State& state) {
  std::size_t i = 0;
  const RenderOptions options{.samples = static_cast<int>(state.range(0)),
                              .shadows = state.range(1) != 0};
  for (auto _ : state) {
    benchmark::DoNotOptimize(render(scene(), rig().cameras[0], place(i++), options));
  }
}

void depths(benchmark::State& state) {
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(depths_m(scene(), rig().cameras[0], place(i++)));
}

void lens_and_sensor(benchmark::State& state) {
  const auto radiance = render(scene(), rig().cameras[0], place(3));
  SensorOptions options;
  options.exposure = 1;
  for (auto _ : state) {
    benchmark::DoNotOptimize(sensed(through_lens(radiance, rig().cameras[0], options), options));
  }
}

void pair_with_truth(benchmark::State& state) {
  std::size_t i = 0;
  const stereo::RectifiedGeometry geometry = stereo::rectified_geometry(rig());
  for (auto _ : state) {
    const Pose T = place(i++);
    const RectifiedView view = rectified_view(rig(), geometry, T);
    benchmark::DoNotOptimize(rendered_pair(scene(), rig(), rig(), view.geometry, T, {}, {}));
    benchmark::DoNotOptimize(pair_truth(scene(), rig(), view, 1));
  }
}

/// A z-buffer of convex polygons as triangles.
class ZBuffer {
 public:
  ZBuffer(int width, int height)
      : width_(width),
        height_(height),
        depth_(static_cast<std::size_t>(width) * height),
        grey_(depth_.size()) {}

  void clear() {
    std::fill(depth_.begin(), depth_.end(), std::numeric_limits<float>::infinity());
    std::fill(grey_.begin(), grey_.end(), 0.0F);
  }

  /// A triangle in the camera's frame, clipped at 5 cm.
  void draw(const std::array<Vector3d, 3>& corners, const Camera& camera, float grey) {
    constexpr double near_m = 0.05;
    std::array<Vector3d, 4> kept;
    std::size_t n = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3d &p = corners[k], &q = corners[(k + 1) % 3];
      if (p.z() >= near_m) kept[n++] = p;
      if ((p.z() >= near_m) != (q.z() >= near_m)) {
        kept[n++] = p + (near_m - p.z()) / (q.z() - p.z()) * (q - p);
      }
    }
    for (std::size_t k = 1; k + 1 < n; ++k) fill(kept[0], kept[k], kept[k + 1], camera, grey);
  }

  const std::vector<float>& grey() const { return grey_; }

 private:
  void fill(
      const Vector3d& a, const Vector3d& b, const Vector3d& c, const Camera& camera, float grey) {
    const std::array<Vector3d, 3> x{a, b, c};
    std::array<Vector3d, 3> p;  // u, v, 1 / z
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = {camera.f_px() * camera.ax() * x[k].x() / x[k].z() + camera.ox_px(),
              camera.f_px() * x[k].y() / x[k].z() + camera.oy_px(), 1 / x[k].z()};
    }
    const double area = (p[1].x() - p[0].x()) * (p[2].y() - p[0].y()) -
                        (p[1].y() - p[0].y()) * (p[2].x() - p[0].x());
    if (area == 0) return;
    const auto [u0, u1] = std::minmax({p[0].x(), p[1].x(), p[2].x()});
    const auto [v0, v1] = std::minmax({p[0].y(), p[1].y(), p[2].y()});
    const int x0 = std::max(0, int(std::ceil(std::max(u0, -1.0)))),
              x1 = std::min(width_ - 1, int(std::floor(std::min(u1, 1e6))));
    const int y0 = std::max(0, int(std::ceil(std::max(v0, -1.0)))),
              y1 = std::min(height_ - 1, int(std::floor(std::min(v1, 1e6))));
    // Barycentric coordinates and 1 / z are linear in the image.
    const auto weight = [&](std::size_t i, std::size_t j, double u, double v) {
      return ((p[j].x() - p[i].x()) * (v - p[i].y()) - (p[j].y() - p[i].y()) * (u - p[i].x())) /
             area;
    };
    for (int y = y0; y <= y1; ++y) {
      for (int u = x0; u <= x1; ++u) {
        const double w0 = weight(1, 2, u, y), w1 = weight(2, 0, u, y), w2 = 1 - w0 - w1;
        if (w0 < 0 || w1 < 0 || w2 < 0) continue;
        const auto z = static_cast<float>(1 / (w0 * p[0].z() + w1 * p[1].z() + w2 * p[2].z()));
        const std::size_t at = static_cast<std::size_t>(y) * width_ + u;
        if (z >= depth_[at]) continue;
        depth_[at] = z;
        grey_[at] = grey;
      }
    }
  }

  int width_, height_;
  std::vector<float> depth_, grey_;
};

void plain_z_buffer(benchmark::State& state) {
  const Camera& camera = rig().cameras[0];
  const ConvexSurfaces surfaces = convex_surfaces(world());
  ZBuffer buffer(camera.size_px[0], camera.size_px[1]);
  std::size_t i = 0;
  for (auto _ : state) {
    const Pose T = place(i++);
    buffer.clear();
    for (const ConvexSurface& piece : surfaces.pieces) {
      const Vector3d* p = surfaces.vertices_m.data() + piece.first_vertex;
      const auto grey = static_cast<float>(0.5 + 0.4 * piece.normal.dot(Vector3d(0.48, 0.6, 0.64)));
      for (int k = 1; k + 1 < piece.vertex_count; ++k) {
        buffer.draw({T * p[0], T * p[k], T * p[k + 1]}, camera, grey);
      }
    }
    benchmark::DoNotOptimize(buffer.grey().data());
  }
}

BENCHMARK(make_scene)->Unit(benchmark::kMillisecond);
BENCHMARK(plain_z_buffer)->Unit(benchmark::kMillisecond);
BENCHMARK(one_eye)
    ->ArgNames({"samples", "shadows"})
    ->Args({1, 0})
    ->Args({2, 0})
    ->Args({4, 0})
    ->Args({8, 0})
    ->Args({4, 1})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(depths)->Unit(benchmark::kMillisecond);
BENCHMARK(lens_and_sensor)->Unit(benchmark::kMillisecond);
BENCHMARK(pair_with_truth)->Unit(benchmark::kMillisecond);

}  // namespace
