// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/render.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "calib/camera.h"
#include "calib/statistics/random.h"
#include "sim/images/depths.h"
#include "sim/images/image_scene.h"
#include "sim/images/pixel_rays.h"
#include "sim/noise_free_view.h"
#include "tests/support/error_message.h"
#include "tests/support/painted_room.h"
#include "tests/support/small_office.h"

namespace vernier::test {

using vernier::internal::RandomStream;
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using stereo::GreyLevels;

Pose office_pose(int node = 2) {
  return T_left_world(map_poses(small_office().route, 2)[static_cast<std::size_t>(node)], {});
}

/// The nominal left camera, with twice and a half its distortion.
Camera bent_camera() {
  Camera camera = nominal_rig().rig.cameras[0];
  camera.parameters[core_parameter_count] = -0.13;
  return camera;
}

World surfaces_only(World world) {
  world.segments.clear();
  return world;
}

/// Whether x, in the plane of a polygon, is inside it: the angles that its corners subtend sum to
/// 2π.
bool encloses(const std::vector<Vector3d>& polygon, const Vector3d& x, const Vector3d& normal) {
  double turn = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vector3d p = polygon[k] - x, q = polygon[(k + 1) % polygon.size()] - x;
    turn += std::atan2(normal.dot(p.cross(q)), p.dot(q));
  }
  return std::abs(turn) > 3;
}

double nearest_depth(const World& world, const Vector3d& eye, const Vector3d& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const WorldSurface& s : world.surfaces) {
    const Vector3d normal =
        (s.polygon_m[1] - s.polygon_m[0]).cross(s.polygon_m[2] - s.polygon_m[1]).normalized();
    const double t = normal.dot(s.polygon_m[0] - eye) / normal.dot(direction);
    if (t > 0 && t < nearest && encloses(s.polygon_m, eye + t * direction, normal)) nearest = t;
  }
  return nearest;
}

TEST(Render, DepthsAreThoseOfTheNearestPlaneByBruteForce) {
  const World world = surfaces_only(small_office());
  const ImageScene scene = image_scene(world);
  const Camera camera = bent_camera();
  const Pose T = office_pose();
  const std::vector<double> depths = depths_m(scene, camera, T);
  RandomStream draws({.seed = 5});
  int other_face = 0;
  constexpr int pixels = 1500;
  for (int i = 0; i < pixels; ++i) {
    const int x = static_cast<int>(draws.below(640)), y = static_cast<int>(draws.below(480));
    const Vector3d ray = unproject(camera, {double(x), double(y)});
    const double expected = nearest_depth(world, T.inverse().t, T.R.transpose() * ray);
    // A pixel centre within a float's rounding of an edge may see the other side of it.
    if (std::abs(depths[640 * y + x] - expected) > 1e-9 * expected) ++other_face;
  }
  RecordProperty("other_face", other_face);
  EXPECT_LE(other_face, 2);
}

/// Where a blurred step between two levels crosses a row: the excess over one level, summed.
double crossing(const GreyLevels& image, int row, int from, int to, double at_from, double at_to) {
  double sum = 0;
  for (int x = from; x <= to; ++x) sum += (image(x, row) - at_to) / (at_from - at_to);
  return from - 0.5 + sum;
}

/// Where the image of a segment crosses a row, by bisection.
double true_crossing(const Camera& camera, const Vector3d& a, const Vector3d& b, double row) {
  double low = 0, high = 1;
  const auto v = [&](double t) { return project(camera, Vector3d(a + t * (b - a)))[1]; };
  const bool rises = v(1) > v(0);
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    ((v(middle) < row) == rises ? low : high) = middle;
  }
  return project(camera, Vector3d(a + low * (b - a)))[0];
}

TEST(Render, EdgesStandWhereTheDistortedCameraProjectsThem) {
  const World world = panel_room();
  ImageSceneOptions options;
  options.appearance.texture_contrast = 0;
  options.lighting.lamps = false;
  const ImageScene scene = image_scene(world, options);
  const Camera camera = bent_camera();
  const Pose T = T_left_world({0, 0, 0}, {});
  const GreyLevels image = render(scene, camera, T, {});
  const std::vector<Vector3d>& panel = world.surfaces[1].polygon_m;
  int rows = 0;
  double sum = 0, sum2 = 0, worst = 0;
  for (const auto& [p, q] : {std::pair{panel[1], panel[2]}, std::pair{panel[3], panel[0]}}) {
    const Vector3d a = T * p, b = T * q;
    const double va = project(camera, a)[1], vb = project(camera, b)[1];
    for (int row = int(std::min(va, vb)) + 12; row < std::max(va, vb) - 12; ++row) {
      const double expected = true_crossing(camera, a, b, row);
      const int left = int(std::round(expected)) - 5, right = left + 10;
      const double found = crossing(image, row, left, right, image(left, row), image(right, row));
      const double error = found - expected;
      ++rows;
      sum += error;
      sum2 += error * error;
      worst = std::max(worst, std::abs(error));
    }
  }
  RecordProperty("edge_rows", rows);
  RecordProperty("edge_mean_px", std::to_string(sum / rows));
  RecordProperty("edge_rms_px", std::to_string(std::sqrt(sum2 / rows)));
  ASSERT_GT(rows, 200);
  EXPECT_LT(std::abs(sum / rows), 0.003);
  EXPECT_LT(std::sqrt(sum2 / rows), 0.03);
  EXPECT_LT(worst, 0.1);
}

TEST(Render, MoreSamplesPlaceAnEdgeBetter) {
  const World world = panel_room();
  ImageSceneOptions options;
  options.appearance.texture_contrast = 0;
  const ImageScene scene = image_scene(world, options);
  const Pose T = T_left_world({0, 0, 0}, {});
  const GreyLevels fine = render(scene, bent_camera(), T, {.samples = 16});
  double last = 1;
  for (const int samples : {1, 2, 4, 8}) {
    const GreyLevels image = render(scene, bent_camera(), T, {.samples = samples});
    double sum2 = 0;
    for (std::size_t i = 0; i < image.values.size(); ++i) {
      sum2 += std::pow(image.values[i] - fine.values[i], 2);
    }
    const double rms = std::sqrt(sum2 / static_cast<double>(image.values.size()));
    EXPECT_LT(rms, 0.75 * last) << samples;
    last = rms;
  }
}

TEST(Render, RaysBetweenPixelCornersAreThoseOfTheLens) {
  for (const Camera& camera : {nominal_rig().rig.cameras[0], bent_camera()}) {
    double worst = 0;
    for (int row = 0; row < 480; row += 13) {
      const RowRays rays(camera, row);
      for (int x = 0; x < 640; x += 7) {
        for (const Vector2d& at : sample_places(4)) {
          const Vector2d ray = rays.at(x, at.x(), at.y());
          const Vector2d pixel = project(camera, {ray.x(), ray.y(), 1});
          worst = std::max(worst, (pixel - Vector2d(x + at.x() - 0.5, row + at.y() - 0.5)).norm());
        }
      }
    }
    EXPECT_LT(worst, 5e-4);
  }
}

TEST(Render, SamplesFillEveryCellColumnAndRow) {
  for (const int n : {1, 2, 4, 5}) {
    std::vector<int> columns(n * n, 0), rows(n * n, 0), cells(n * n, 0);
    for (const Vector2d& at : sample_places(n)) {
      ++columns[static_cast<std::size_t>(at.x() * n * n)];
      ++rows[static_cast<std::size_t>(at.y() * n * n)];
      ++cells[static_cast<std::size_t>(at.x() * n) * n + static_cast<std::size_t>(at.y() * n)];
    }
    const std::vector<int> once(n * n, 1);
    EXPECT_EQ(columns, once);
    EXPECT_EQ(rows, once);
    EXPECT_EQ(cells, once);
  }
}

TEST(Render, IsTheSameForAnyNumberOfThreads) {
  const ImageScene scene = image_scene(small_office());
  const Camera camera = bent_camera();
  const GreyLevels one = render(scene, camera, office_pose(), {.shadows = true, .threads = 1});
  const std::vector<double> depths = depths_m(scene, camera, office_pose(), 1);
  for (const int threads : {2, 8}) {
    EXPECT_EQ(render(scene, camera, office_pose(), {.shadows = true, .threads = threads}).values,
              one.values);
    const std::vector<double> again = depths_m(scene, camera, office_pose(), threads);
    EXPECT_TRUE(std::equal(again.begin(), again.end(), depths.begin(), [](double a, double b) {
      return a == b || (std::isnan(a) && std::isnan(b));
    }));
  }
}

// Embree, told to use one thread, let the whole process have no more: a study that drew images went
// on with one.
TEST(Render, LeavesTheProcessItsThreads) {
  constexpr auto limit = tbb::global_control::max_allowed_parallelism;
  const tbb::global_control four(limit, 4);
  const ImageScene scene = image_scene(small_office());
  EXPECT_EQ(tbb::global_control::active_value(limit), 4u);
}

TEST(Render, ShadowsOnlyDarken) {
  const ImageScene scene = image_scene(small_office());
  const Camera camera = nominal_rig().rig.cameras[0];
  const GreyLevels lit = render(scene, camera, office_pose(), {});
  const GreyLevels shaded = render(scene, camera, office_pose(), {.shadows = true});
  int darker = 0;
  for (std::size_t i = 0; i < lit.values.size(); ++i) {
    ASSERT_LE(shaded.values[i], lit.values[i] * 1.01 + 1e-4);
    if (shaded.values[i] < 0.9 * lit.values[i]) ++darker;
  }
  EXPECT_GT(darker, 10'000);
  EXPECT_LT(darker, 640 * 480);
}

TEST(Render, RefusesWhatCannotBeRendered) {
  World empty = small_office();
  empty.surfaces.clear();
  EXPECT_NE(error_message([&] { image_scene(empty); }).find("has no surfaces"), std::string::npos);
  const ImageScene scene = image_scene(panel_room());
  Camera huge = bent_camera();
  huge.size_px = {200'000, 200'000};
  EXPECT_NE(error_message([&] { render(scene, huge, office_pose()); }).find("limit: 1e8"),
            std::string::npos);
  EXPECT_NE(error_message([&] { depths_m(scene, huge, office_pose()); }).find("limit: 1e8"),
            std::string::npos);
  EXPECT_NE(error_message([&] {
              render(scene, bent_camera(), office_pose(), {.samples = 17});
            }).find("from 1 to 16"),
            std::string::npos);
  ImageSceneOptions bad;
  bad.appearance.largest_reflectance = 1.5;
  EXPECT_NE(error_message([&] { image_scene(panel_room(), bad); }).find("reflectances"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier::test
