// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <vector>

#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/statistics/random.h"
#include "sim/world.h"

namespace vernier::test {

using namespace vernier::internal;
using namespace vernier::sim;

using Eigen::Vector2d;
using Eigen::Vector3d;
using Polygon = std::vector<Vector3d>;

inline Camera camera_with(double f_px, double k1) {
  Camera camera;
  camera.model = Radial1{};
  camera.parameters.resize(5);
  camera.parameters << f_px, 1.01, 322.3, 236.1, k1;
  return camera;
}

/// A camera at `eye` that looks at `target`, upright in a world with z up.
inline Pose looking_at(const Vector3d& eye, const Vector3d& target) {
  const Vector3d z = (target - eye).normalized(), x = z.cross(Vector3d::UnitZ()).normalized();
  Pose T;
  T.R << x.transpose(), z.cross(x).transpose(), z.transpose();
  T.t = -T.R * eye;
  return T;
}

inline void add_surface(World& world, const Polygon& polygon, bool with_border = false) {
  world.surfaces.push_back({polygon, 0});
  for (std::size_t i = 0; with_border && i < polygon.size(); ++i) {
    world.segments.push_back({polygon[i], polygon[(i + 1) % polygon.size()], 0});
  }
}

/// A closed box with its twelve edges: `T` places the box [0, size].
inline void add_box(World& world, const Pose& T, const Vector3d& size) {
  const auto corner = [&](int i) {
    return T * size.cwiseProduct(Vector3d(i & 1, (i >> 1) & 1, (i >> 2) & 1));
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = 1 << ((axis + 1) % 3), v = 1 << ((axis + 2) % 3);
    for (int side : {0, 1 << axis}) {
      add_surface(world, {corner(side), corner(side + u), corner(side + u + v), corner(side + v)});
    }
    for (int i : {0, u, v, u + v}) {
      world.segments.push_back({corner(i), corner(i + (1 << axis)), 0});
    }
  }
}

/// An upright wall in the plane y = `y`, from points (x, z).
inline Polygon wall(double y, std::initializer_list<Vector2d> points) {
  Polygon polygon;
  for (const Vector2d& p : points) polygon.emplace_back(p[0], y, p[1]);
  return polygon;
}

inline Vector3d random_point(RandomStream& draws, const Vector3d& low, const Vector3d& high) {
  const double x = draws.uniform(low[0], high[0]), y = draws.uniform(low[1], high[1]);
  return {x, y, draws.uniform(low[2], high[2])};
}

inline Pose random_pose(RandomStream& draws, const Vector3d& low, const Vector3d& high) {
  const double x = draws.normal(), y = draws.normal(), z = draws.normal();
  return {rotation_from_vector({x, y, z}), random_point(draws, low, high)};
}

/// A star with spikes of random length: anything but convex.
inline Polygon random_star(RandomStream& draws, const Pose& T) {
  Polygon polygon;
  const int n = 5 + static_cast<int>(draws.below(10));
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n, r = draws.uniform(0.1, 1);
    polygon.push_back(T * Vector3d(r * std::cos(angle), r * std::sin(angle), 0));
  }
  return polygon;
}

/// A comb: every second tooth is missing, all corners are right angles.
inline Polygon comb(const Pose& T) {
  Polygon polygon;
  for (int i = 0; i < 4; ++i) {
    for (const Vector2d& p : {Vector2d(i, 1), Vector2d(i, 0), Vector2d(i + 0.5, 0)}) {
      polygon.push_back(T * Vector3d(0.3 * p[0], p[1], 0));
    }
    polygon.push_back(T * Vector3d(0.3 * (i + 0.5), 1, 0));
  }
  polygon.push_back(T * Vector3d(1.05, 1.5, 0));
  polygon.push_back(T * Vector3d(0, 1.5, 0));
  return polygon;
}

inline World random_world(RandomStream& draws) {
  World world;
  const Vector3d low(-3, -3, 0), high(3, 3, 2.5);
  add_box(world, {Eigen::Matrix3d::Identity(), {-4, -4, 0}}, {8, 8, 2.5});
  for (int i = 0; i < 12; ++i) {
    const Vector3d size = random_point(draws, {0.1, 0.1, 0.1}, {1.5, 1.5, 1.5});
    add_box(world, random_pose(draws, low, high), size);
    add_surface(world, random_star(draws, random_pose(draws, low, high)), true);
  }
  for (int i = 0; i < 4; ++i) add_surface(world, comb(random_pose(draws, low, high)), true);
  for (int i = 0; i < 40; ++i) {
    const Vector3d a = random_point(draws, low, high);
    world.segments.push_back({a, random_point(draws, low, high), 0});
    world.corners.push_back({random_point(draws, low, high), 0});
  }
  return world;
}

}  // namespace vernier::test
