// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/built/built_world.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/statistics/random.h"
#include "localise/joined_lines.h"
#include "sim/built/depth_cloud.h"
#include "sim/built/planar_patches.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "stereo/image/depth_image.h"
#include "tests/support/error_message.h"

namespace vernier::sim::internal {
namespace {

using Eigen::Vector3d;
using stereo::internal::DepthImage;
using vernier::internal::RandomStream;

Camera pinhole() {
  Camera camera;
  camera.size_px = {240, 180};
  camera.model = Pinhole{};
  camera.parameters = Eigen::Vector4d(200, 1, 119.5, 89.5);
  return camera;
}

/// n . x = d, seen from the side that n points to.
struct Wall {
  Vector3d n;
  double d;
};

/// A room of x in [0, 4], y in [0, 4] and a floor at 0, open above.
const std::vector<Wall> room{{Vector3d::UnitX(), 0},
                             {-Vector3d::UnitX(), -4},
                             {Vector3d::UnitY(), 0},
                             {-Vector3d::UnitY(), -4},
                             {Vector3d::UnitZ(), 0}};

/// A level camera at (x, y), 1.5 m high, that looks along the heading, tilted down.
Pose camera_at(double x, double y, double heading_rad) {
  const Eigen::Matrix3d R = rotation_from_vector({0, 0, heading_rad}) *
                            rotation_from_vector({0, 0.5, 0}) *
                            (Eigen::Matrix3d() << 0, 0, 1, -1, 0, 0, 0, -1, 0).finished();
  return {R, {x, y, 1.5}};
}

/// What it measures of the room, with noise new at each pixel and an error of the whole map.
DepthImage depth_of(const Pose& T, double sigma_m, double shared_m, std::uint32_t view) {
  const Camera camera = pinhole();
  RandomStream draws({.seed = 3, .feature = view});
  const double common = shared_m * draws.normal();
  DepthImage depth{camera.size_px.x(), camera.size_px.y(), {}};
  for (int v = 0; v < depth.height_px; ++v) {
    for (int u = 0; u < depth.width_px; ++u) {
      const Vector3d ray = T.R * unproject(camera, Eigen::Vector2d(u, v));
      double nearest = std::numeric_limits<double>::infinity();
      for (const Wall& wall : room) {
        const double slope = wall.n.dot(ray);
        if (slope < 0) nearest = std::min(nearest, (wall.d - wall.n.dot(T.t)) / slope);
      }
      // above 2.5 m nothing is known
      const bool known = (T.t + nearest * ray).z() < 2.5;
      depth.depth_m.push_back(
          known ? static_cast<float>(nearest + common + sigma_m * draws.normal()) : 0.0F);
    }
  }
  return depth;
}

struct Seen {
  std::vector<Pose> T_world_camera;
  DepthCloud cloud;
};

Seen seen_room(double sigma_m, double shared_m) {
  Seen seen;
  for (int i = 0; i < 16; ++i) {
    const Pose T = camera_at(2 + 0.8 * std::cos(0.7 * i), 2 + 0.8 * std::sin(0.7 * i), 0.8 * i);
    seen.T_world_camera.push_back(T);
    seen.cloud.add(depth_of(T, sigma_m, shared_m, i), pinhole(), T);
  }
  return seen;
}

localise::JoinedLine line(const Vector3d& a, const Vector3d& b, int views) {
  localise::JoinedLine made;
  made.a_m = a;
  made.b_m = b;
  made.views = views;
  made.covariance_m2.setIdentity();
  made.covariance_m2 *= 1e-4;
  return made;
}

double area_of(const std::vector<Vector3d>& polygon) {
  Vector3d twice = Vector3d::Zero();
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    twice += (polygon[i - 1] - polygon[0]).cross(polygon[i] - polygon[0]);
  }
  return 0.5 * twice.norm();
}

TEST(PlanarPatches, LieOnTheWallsAndFaceTheCameras) {
  const Seen seen = seen_room(0.01, 0.005);
  double area = 0, astray = 0;
  for (const Patch& patch : planar_patches(seen.cloud)) {
    double least = 1;
    for (const Wall& wall : room) {
      double off = wall.n.dot(patch.normal) > 0.9 ? 0 : 1;
      for (const Vector3d& p : patch.polygon_m) {
        off = std::max(off, std::abs(wall.n.dot(p) - wall.d));
      }
      least = std::min(least, off);
    }
    EXPECT_GE(patch.views, 2);
    area += area_of(patch.polygon_m);
    // a small cell that a corner of the room cuts may be flat enough with both sides in it
    if (least > 0.06) astray += area_of(patch.polygon_m);
  }
  EXPECT_LT(astray, 0.02 * area);
  // walls of 4 x 4 x about 2.5 m and the floor, as far as they are seen: 56 m² at most
  EXPECT_GT(area, 35);
  EXPECT_LT(area, 60);
}

TEST(PlanarPatches, DoNotCloseAnOpening) {
  // a wall at x = 3 with a door of 0.9 m in it, and nothing beyond
  DepthCloud cloud;
  for (int view = 0; view < 3; ++view) {
    const Pose T = camera_at(0.1 * view, 0, 0);
    DepthImage depth{240, 180, {}};
    for (int v = 0; v < 180; ++v) {
      for (int u = 0; u < 240; ++u) {
        const Vector3d ray = T.R * unproject(pinhole(), Eigen::Vector2d(u, v));
        const double z = (3 - T.t.x()) / ray.x();
        const double y = (T.t + z * ray).y();
        depth.depth_m.push_back(std::abs(y) < 0.45 ? 0.0F : static_cast<float>(z));
      }
    }
    cloud.add(depth, pinhole(), T);
  }
  for (const Patch& patch : planar_patches(cloud)) {
    for (const Vector3d& p : patch.polygon_m) EXPECT_GT(std::abs(p.y()), 0.40);
  }
}

TEST(BuiltWorld, NoiseOfASurfaceHidesNoLineOnIt) {
  const Seen seen = seen_room(0.015, 0.01);
  localise::JoinedLines lines;
  // on the walls, at the floor, and an edge between two walls
  for (double s = 0.5; s < 3.6; s += 0.5) {
    lines.lines.push_back(line({s, 0, 0.5}, {s, 0, 2}, 3));
    lines.lines.push_back(line({0, s, 0.5}, {0, s, 2}, 3));
    lines.lines.push_back(line({s, 4, 0.5}, {s + 0.3, 4, 0.5}, 3));
    lines.lines.push_back(line({s, 0, 0}, {s + 0.4, 0, 0}, 3));
  }
  lines.lines.push_back(line({0, 0, 0.2}, {0, 0, 2.2}, 3));
  const BuiltWorld built = built_world(lines, planar_patches(seen.cloud), seen.T_world_camera, {});
  const World world = build_world(built.world);
  ASSERT_EQ(world.segments.size(), lines.lines.size());
  const Visibility visibility(world);
  // the line between a wall and the floor may lie behind a patch that bridges both
  const auto hidden =
      std::count_if(world.segments.begin(), world.segments.end(), [&](const WorldSegment& s) {
        return !visibility.sees({2, 2, 1.5}, 0.5 * (s.a_m + s.b_m));
      });
  EXPECT_LE(hidden, 1);
  // and they hide what is behind them: outside of the room
  EXPECT_FALSE(visibility.sees({2, 2, 1.5}, {2.03, -1, 1.2}));
  EXPECT_FALSE(visibility.sees({2, 2, 1.5}, {-1, 2.07, 1.2}));
}

TEST(BuiltWorld, KeepsWhatEnoughViewsSawAndTheWay) {
  localise::JoinedLines lines;
  lines.lines = {line({1, 1, 0}, {1, 1, 2}, 1), line({1, 2, 0}, {1, 2, 2}, 2),
                 line({1, 3, 1}, {1, 3, 1.001}, 5), line({2, 3, 1}, {2, 3, 2}, 5)};
  std::vector<Pose> way;
  for (int i = 0; i < 5; ++i) way.push_back(camera_at(i, 0.5, 0));
  const BuiltWorld built = built_world(lines, {}, way);
  EXPECT_EQ(built.of_lines, (std::vector<int>{1, 3}));
  EXPECT_EQ(built.report.joined, 4U);
  EXPECT_EQ(built.report.lines, 2U);
  EXPECT_FALSE(built.report.floor_m);
  EXPECT_NEAR(route_length_m(build_world(built.world).route), 4, 1e-9);
}

TEST(BuiltWorld, NothingStandsWhereTheCameraWas) {
  Patch post;  // across the way, waist high
  post.polygon_m = {{1, 0.3, 0.5}, {1, 0.7, 0.5}, {1, 0.7, 1}, {1, 0.3, 1}};
  post.normal = -Vector3d::UnitX();
  Patch overhead = post;
  for (Vector3d& p : overhead.polygon_m) p.z() += 1.5;
  Patch beside = post;
  for (Vector3d& p : beside.polygon_m) p.y() += 1;
  std::vector<Pose> way;
  for (int i = 0; i < 30; ++i) way.push_back(camera_at(0.1 * i, 0.5, 0));
  const BuiltWorld built = built_world({}, {post, overhead, beside}, way);
  EXPECT_EQ(built.report.on_the_way, 1U);
  EXPECT_EQ(built.report.surfaces, 2U);
}

TEST(BuiltWorld, NothingStandsBetweenTwoPlacesOfTheCamera) {
  // 2 m apart, and then a jump of 4 m, over which nobody is known to have walked
  const std::vector<Pose> way{camera_at(0, 0.5, 0), camera_at(2, 0.5, 0), camera_at(6, 0.5, 0)};
  const auto post = [](double x, double low_y, double high_y, double width) {
    Patch patch;
    patch.polygon_m = {
        {x, low_y, 0.5}, {x + width, high_y, 0.5}, {x + width, high_y, 1}, {x, low_y, 1}};
    patch.normal = -Vector3d::UnitX();
    return patch;
  };
  const auto left_out = [&](const Patch& patch) {
    return built_world({}, {patch}, way, {.recede_m = 0}).report.on_the_way == 1;
  };
  EXPECT_TRUE(left_out(post(1, 0.45, 0.55, 0)));     // across, narrow
  EXPECT_TRUE(left_out(post(1, -2, 3, 0.1)));        // across, both ends far from it
  EXPECT_TRUE(left_out(post(0.5, 0.65, 0.65, 1)));   // beside, 0.15 m
  EXPECT_FALSE(left_out(post(0.5, 0.75, 0.75, 1)));  // 0.25 m
  EXPECT_FALSE(left_out(post(1, 0.71, 3, 0)));
  EXPECT_FALSE(left_out(post(4, 0.3, 0.7, 0)));  // in the jump
  Patch table;                                   // over the way, its edges far
  table.polygon_m = {{-1, -1, 0.7}, {3, -1, 0.7}, {3, 2, 0.7}, {-1, 2, 0.7}};
  table.normal = Vector3d::UnitZ();
  EXPECT_TRUE(left_out(table));
}

TEST(BuiltWorld, FindsTheFloor) {
  const Seen seen = seen_room(0.01, 0.005);
  std::vector<Patch> patches = planar_patches(seen.cloud);
  const auto found = built_world({}, patches, seen.T_world_camera).report.floor_m;
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 0, 0.01);
  for (Patch& patch : patches) {
    for (Vector3d& p : patch.polygon_m) p.z() += 0.3;
  }
  EXPECT_NEAR(built_world({}, patches, seen.T_world_camera).report.floor_m.value(), 0.3, 0.01);
}

TEST(DepthCloud, RefusesAnotherCamera) {
  DepthCloud cloud;
  const DepthImage depth{4, 4, std::vector<float>(16, 1.0F)};
  EXPECT_NE(test::error_message([&] { cloud.add(depth, pinhole(), {}); }).find("240x180"),
            std::string::npos);
  Camera lens = pinhole();
  lens.model = Radial1{};
  EXPECT_NE(test::error_message([&] { cloud.add(depth, lens, {}); }).find("distortion"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier::sim::internal
