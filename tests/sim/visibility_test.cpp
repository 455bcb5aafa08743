// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/visibility.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <set>

#include "calib/error.h"
#include "calib/random.h"

namespace vernier {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Polygon = std::vector<Vector3d>;

Camera camera_with(double f_px, double k1) {
  Camera camera;
  camera.model = Radial1{};
  camera.parameters.resize(5);
  camera.parameters << f_px, 1.01, 322.3, 236.1, k1;
  return camera;
}

/// A camera at `eye` that looks at `target`, upright in a world with z up.
Pose looking_at(const Vector3d& eye, const Vector3d& target) {
  const Vector3d z = (target - eye).normalized(), x = z.cross(Vector3d::UnitZ()).normalized();
  Pose T;
  T.R << x.transpose(), z.cross(x).transpose(), z.transpose();
  T.t = -T.R * eye;
  return T;
}

void add_surface(World& world, const Polygon& polygon, bool with_border = false) {
  world.surfaces.push_back({polygon, 0});
  for (std::size_t i = 0; with_border && i < polygon.size(); ++i) {
    world.segments.push_back({polygon[i], polygon[(i + 1) % polygon.size()], 0});
  }
}

/// A closed box with its twelve edges: `T` places the box [0, size].
void add_box(World& world, const Pose& T, const Vector3d& size) {
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
Polygon wall(double y, std::initializer_list<Vector2d> points) {
  Polygon polygon;
  for (const Vector2d& p : points) polygon.emplace_back(p[0], y, p[1]);
  return polygon;
}

/// Whether a ray from the eye through x meets the polygon's interior before x, by counting how
/// often a half-line in the plane crosses the border. Shares nothing with the code under test.
bool blocks(const Polygon& polygon, const Vector3d& eye, const Vector3d& x, double gap_m) {
  Vector3d n = Vector3d::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    n += polygon[i].cross(polygon[(i + 1) % polygon.size()]);
  }
  if (n.norm() < 1e-9) return false;
  n.normalize();
  const double h_eye = n.dot(eye - polygon[0]), h_x = n.dot(x - polygon[0]);
  if (h_eye * h_x >= 0 || std::abs(h_x) <= gap_m) return false;
  const Vector3d hit = eye + h_eye / (h_eye - h_x) * (x - eye);
  int drop = 0;
  n.cwiseAbs().maxCoeff(&drop);
  const int i = (drop + 1) % 3, j = (drop + 2) % 3;
  bool inside = false;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vector3d &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    if ((p[j] > hit[j]) == (q[j] > hit[j])) continue;
    if (hit[i] < p[i] + (hit[j] - p[j]) / (q[j] - p[j]) * (q[i] - p[i])) inside = !inside;
  }
  return inside;
}

/// The slow way to ask what a camera sees of one point.
struct Oracle {
  const World& world;
  const Camera& camera;
  Pose T_camera_world;
  VisibilityOptions options;

  bool sees(const Vector3d& point) const {
    const Vector3d x = T_camera_world * point;
    if (x.z() < options.near_m || x.z() > options.far_m) return false;
    const double k1 = camera.parameters.size() > 4 ? camera.parameters[4] : 0;
    if (k1 < 0 && x.head<2>().squaredNorm() > x.z() * x.z() / (-3 * k1)) return false;
    if (!in_image(camera, project(camera, x))) return false;
    const Vector3d eye = T_camera_world.inverse().t;
    for (const WorldSurface& surface : world.surfaces) {
      if (blocks(surface.polygon_m, eye, point, options.surface_gap_m)) return false;
    }
    return true;
  }
};

Vector3d at(const WorldSegment& s, double t) { return s.a_m + t * (s.b_m - s.a_m); }

std::vector<VisibleRun> runs_of(const std::vector<VisibleRun>& runs, int segment) {
  std::vector<VisibleRun> own;
  for (const VisibleRun& run : runs) {
    if (run.segment == segment) own.push_back(run);
  }
  return own;
}

/// Distance in t to the nearest end of a run.
double to_nearest_end(const std::vector<VisibleRun>& runs, double t) {
  double least = 1;
  for (const VisibleRun& r : runs) {
    least = std::min({least, std::abs(t - r.t0), std::abs(t - r.t1)});
  }
  return least;
}

bool in_runs(const std::vector<VisibleRun>& runs, double t) {
  for (const VisibleRun& r : runs) {
    if (t >= r.t0 && t <= r.t1) return true;
  }
  return false;
}

/// Compares runs with the oracle: samples, changes between samples to 1e-6, and both sides of ends.
void expect_same(const Oracle& oracle, const std::vector<VisibleRun>& runs, int samples) {
  for (int i = 0; i < static_cast<int>(oracle.world.segments.size()); ++i) {
    const WorldSegment& segment = oracle.world.segments[i];
    const std::vector<VisibleRun> own = runs_of(runs, i);
    bool before = false;
    for (int k = 0; k < samples; ++k) {
      const double t = (k + 0.5) / samples;
      const bool seen = oracle.sees(at(segment, t));
      if (seen != in_runs(own, t)) {
        EXPECT_LT(to_nearest_end(own, t), 1e-6) << "segment " << i << " at " << t;
      }
      if (k > 0 && seen != before) {
        double t0 = (k - 0.5) / samples, t1 = t;
        while (t1 - t0 > 1e-10) {
          const double middle = 0.5 * (t0 + t1);
          (oracle.sees(at(segment, middle)) == before ? t0 : t1) = middle;
        }
        EXPECT_LT(to_nearest_end(own, t0), 1e-6) << "segment " << i << " changes at " << t0;
      }
      before = seen;
    }
    for (const VisibleRun& r : own) {
      if (r.t1 - r.t0 < 1e-6) continue;
      EXPECT_TRUE(oracle.sees(at(segment, 0.5 * (r.t0 + r.t1)))) << "segment " << i;
      EXPECT_TRUE(oracle.sees(at(segment, r.t0 + 1e-7))) << "segment " << i << " from " << r.t0;
      EXPECT_TRUE(oracle.sees(at(segment, r.t1 - 1e-7))) << "segment " << i << " to " << r.t1;
      if (r.t0 > 1e-6 && !in_runs(own, r.t0 - 1e-7)) {
        EXPECT_FALSE(oracle.sees(at(segment, r.t0 - 1e-7))) << "segment " << i << " at " << r.t0;
      }
      if (r.t1 < 1 - 1e-6 && !in_runs(own, r.t1 + 1e-7)) {
        EXPECT_FALSE(oracle.sees(at(segment, r.t1 + 1e-7))) << "segment " << i << " at " << r.t1;
      }
    }
  }
}

Vector3d random_point(Draws& draws, const Vector3d& low, const Vector3d& high) {
  const double x = draws.uniform(low[0], high[0]), y = draws.uniform(low[1], high[1]);
  return {x, y, draws.uniform(low[2], high[2])};
}

Pose random_pose(Draws& draws, const Vector3d& low, const Vector3d& high) {
  const double x = draws.normal(), y = draws.normal(), z = draws.normal();
  return {rotation_from_vector({x, y, z}), random_point(draws, low, high)};
}

/// A star with spikes of random length: anything but convex.
Polygon random_star(Draws& draws, const Pose& T) {
  Polygon polygon;
  const int n = 5 + static_cast<int>(draws.below(10));
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n, r = draws.uniform(0.1, 1);
    polygon.push_back(T * Vector3d(r * std::cos(angle), r * std::sin(angle), 0));
  }
  return polygon;
}

/// A comb: every second tooth is missing, all corners are right angles.
Polygon comb(const Pose& T) {
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

World random_world(Draws& draws) {
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

TEST(Visibility, AgreesWithDenseRaysInRandomWorlds) {
  const std::vector<Camera> cameras{camera_with(525, 0), camera_with(500, -0.2),
                                    camera_with(420, -0.1), camera_with(480, 0.15)};
  for (std::uint32_t trial = 0; trial < 4; ++trial) {
    Draws draws({.seed = 41, .trial = trial});
    const World world = random_world(draws);
    const Visibility visibility(world);
    for (const Camera& camera : cameras) {
      const Vector3d eye = random_point(draws, {-3, -3, 0.5}, {3, 3, 2});
      const Pose T = looking_at(eye, random_point(draws, {-2, -2, 0.5}, {2, 2, 1.5}));
      const VisibilityOptions options{.far_m = 6, .min_length_px = 0};
      const Oracle oracle{world, camera, T, options};
      expect_same(oracle, visibility.visible_runs(camera, T, options), 60);
      const std::vector<int> corners = visibility.visible_corners(camera, T, options);
      const std::set<int> seen(corners.begin(), corners.end());
      EXPECT_TRUE(std::is_sorted(corners.begin(), corners.end()));
      for (int i = 0; i < static_cast<int>(world.corners.size()); ++i) {
        EXPECT_EQ(seen.count(i) == 1, oracle.sees(world.corners[i].position_m)) << "corner " << i;
      }
    }
  }
}

TEST(Visibility, SeesAgreesWithDenseRays) {
  Draws draws({.seed = 42});
  const World world = random_world(draws);
  const Visibility visibility(world);
  int hidden = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d eye = random_point(draws, {-3, -3, 0}, {3, 3, 2.5});
    const Vector3d point = random_point(draws, {-3, -3, 0}, {3, 3, 2.5});
    bool blocked = false;
    for (const WorldSurface& s : world.surfaces) blocked |= blocks(s.polygon_m, eye, point, 1e-3);
    EXPECT_EQ(visibility.sees(eye, point), !blocked);
    hidden += blocked;
  }
  EXPECT_GT(hidden, 200);
  EXPECT_LT(hidden, 1800);
}

/// How many edges of a box the camera sees; all of them must be seen in full.
int whole_edges(const World& world, const Vector3d& eye, const Vector3d& target) {
  const auto runs =
      Visibility(world).visible_runs(camera_with(500, -0.1), looking_at(eye, target), {});
  for (const VisibleRun& r : runs) {
    EXPECT_EQ(r.t0, 0);
    EXPECT_EQ(r.t1, 1);
    EXPECT_EQ(r.run, 0);
  }
  return static_cast<int>(runs.size());
}

TEST(Visibility, BoxFromOutsideShowsTheEdgesOfItsFrontFaces) {
  const Vector3d size(1, 2, 1.5), centre = size / 2;
  World world;
  add_box(world, {}, size);
  EXPECT_EQ(whole_edges(world, {7, 5, 4}, centre), 9);      // three faces
  EXPECT_EQ(whole_edges(world, {-5, -7.3, 6}, centre), 9);  // three faces, the other side
  EXPECT_EQ(whole_edges(world, {6, 5, 0.7}, centre), 7);    // two faces
  EXPECT_EQ(whole_edges(world, {6, 0.9, 0.7}, centre), 4);  // one face
  // Edge-on to a face: its far edge is in line with its near edge, and behind no interior.
  EXPECT_EQ(whole_edges(world, {6, 5, 1.5}, centre), 7 + 2);
}

TEST(Visibility, TurnedBoxesFromOutsideShowWholeEdges) {
  Draws draws({.seed = 43});
  for (int trial = 0; trial < 200; ++trial) {
    World world;
    const Pose T = random_pose(draws, {-9, -9, -1}, {9, 9, 1});
    const Vector3d size = random_point(draws, {0.5, 0.5, 0.5}, {2, 2, 2});
    add_box(world, T, size);
    const Vector3d eye = random_point(draws, {-20, -20, 3}, {20, 20, 6});
    const Vector3d x = T.inverse() * eye;
    int fronts = 0;
    for (int axis = 0; axis < 3; ++axis) fronts += x[axis] < 0 || x[axis] > size[axis];
    if (fronts == 0 || (eye - T * (size / 2)).norm() < 5) continue;
    const int expected[] = {0, 4, 7, 9};
    const auto runs = Visibility(world).visible_runs(
        camera_with(500, 0), looking_at(eye, T * (size / 2)), {.far_m = 60, .min_length_px = 0});
    ASSERT_EQ(runs.size(), expected[fronts]) << "trial " << trial;
    for (const VisibleRun& r : runs) EXPECT_TRUE(r.t0 == 0 && r.t1 == 1);
  }
}

TEST(Visibility, WallsOfARoomHideNothingInIt) {
  World room, wires;
  add_box(room, {}, {4, 5, 2.5});
  wires.segments = room.segments;
  const Vector3d eye(1.5, 2, 1.2);
  std::set<int> seen;
  for (int i = 0; i < 12; ++i) {
    const double heading = 0.2 + 0.5 * i, pitch = 0.3 * (i % 3 - 1);
    const Vector3d target = eye + Vector3d(std::cos(heading), std::sin(heading), pitch);
    const Camera camera = camera_with(300, -0.05);
    const Pose T = looking_at(eye, target);
    const auto inside = Visibility(room).visible_runs(camera, T);
    const auto open = Visibility(wires).visible_runs(camera, T);
    ASSERT_EQ(inside.size(), open.size());
    for (std::size_t k = 0; k < open.size(); ++k) {
      EXPECT_EQ(inside[k].segment, open[k].segment);
      EXPECT_EQ(inside[k].t0, open[k].t0);
      EXPECT_EQ(inside[k].t1, open[k].t1);
      seen.insert(open[k].segment);
    }
  }
  EXPECT_EQ(seen.size(), 12u);
}

TEST(Visibility, DoorHoleShowsWhatIsBehindItOnly) {
  World world;
  add_surface(
      world,
      wall(2, {{-3, 0}, {-0.5, 0}, {-0.5, 2}, {0.5, 2}, {0.5, 0}, {3, 0}, {3, 2.5}, {-3, 2.5}}));
  world.segments.push_back({{-2, 4, 1}, {2, 4, 1}, 0});       // seen through the door from x = -1
  world.segments.push_back({{-2, 4, 2.4}, {2, 4, 2.4}, 0});   // behind the lintel
  world.segments.push_back({{0, 4, 0.5}, {0, 4, 1.5}, 0});    // all in the door
  world.segments.push_back({{-1.5, 4, 0}, {-1.5, 4, 2}, 0});  // behind the left part
  world.corners = {{{0, 4, 1}, 0}, {{1.5, 4, 1}, 0}};
  const Visibility visibility(world);
  const Pose T = looking_at({0, 0, 1}, {0, 2, 1});
  const auto runs = visibility.visible_runs(camera_with(400, 0), T);
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].segment, 0);
  EXPECT_NEAR(runs[0].t0, 0.25, 1e-12);  // the jambs at x = ±0.5, y = 2 are seen at ±1, y = 4
  EXPECT_NEAR(runs[0].t1, 0.75, 1e-12);
  EXPECT_EQ(runs[1].segment, 2);
  EXPECT_EQ(runs[1].t0, 0);
  EXPECT_EQ(runs[1].t1, 1);
  EXPECT_EQ(visibility.visible_corners(camera_with(400, 0), T), std::vector<int>{0});
}

TEST(Visibility, HoleJoinedToTheBorderByACutIsOpen) {
  World world;  // a window in a wall; the border walks in to it and out again
  add_surface(world, wall(2, {{-3, 0},
                              {3, 0},
                              {3, 2.5},
                              {-3, 2.5},
                              {-3, 0},
                              {-0.5, 0.8},
                              {-0.5, 1.4},
                              {0.5, 1.4},
                              {0.5, 0.8},
                              {-0.5, 0.8}}));
  world.segments.push_back({{-2, 4, 1}, {2, 4, 1}, 0});
  world.segments.push_back({{-2, 4, 0.3}, {2, 4, 0.3}, 0});
  const auto runs =
      Visibility(world).visible_runs(camera_with(400, 0), looking_at({0, 0, 1}, {0, 2, 1}));
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_EQ(runs[0].segment, 0);
  EXPECT_NEAR(runs[0].t0, 0.25, 1e-12);
  EXPECT_NEAR(runs[0].t1, 0.75, 1e-12);
}

TEST(Visibility, SegmentsNearAWallFollowTheGap) {
  World world;
  add_surface(world, wall(2, {{-3, 0}, {3, 0}, {3, 2.5}, {-3, 2.5}}));
  for (double y : {1.99, 2.01, 2.0001, 2.0, 2.0009, 2.0011}) {
    world.segments.push_back({{-0.5, y, 1}, {0.5, y, 1}, 0});
    world.corners.push_back({{0.2, y, 1}, 0});
  }
  const Visibility visibility(world);
  const Pose T = looking_at({0.3, -1, 1.3}, {0, 2, 1});
  const auto runs = visibility.visible_runs(camera_with(500, 0), T);
  std::vector<int> seen;
  for (const VisibleRun& r : runs) {
    seen.push_back(r.segment);
    EXPECT_TRUE(r.t0 == 0 && r.t1 == 1);
  }
  EXPECT_EQ(seen, (std::vector<int>{0, 2, 3, 4}));
  EXPECT_EQ(visibility.visible_corners(camera_with(500, 0), T), (std::vector<int>{0, 2, 3, 4}));
  EXPECT_TRUE(visibility.sees({0.3, -1, 1.3}, {0, 2.0009, 1}));
  EXPECT_FALSE(visibility.sees({0.3, -1, 1.3}, {0, 2.0011, 1}));
  EXPECT_TRUE(visibility.sees({0.3, -1, 1.3}, {0, 2.0011, 1}, {.surface_gap_m = 2e-3}));
}

TEST(Visibility, RunsAreNumberedBeforeShortOnesAreLeftOut) {
  World world;  // a fence of narrow slats before a line
  for (int i = 0; i < 5; ++i) {
    const double x = -1 + 0.5 * i;
    add_surface(
        world,
        wall(2, {{x, 0}, {x + (i == 2 ? 0.49 : 0.2), 0}, {x + (i == 2 ? 0.49 : 0.2), 2}, {x, 2}}));
  }
  world.segments.push_back({{-2, 4, 1}, {2, 4, 1}, 0});
  const Visibility visibility(world);
  const Pose T = looking_at({0, 0, 1}, {0, 2, 1});
  const auto all = visibility.visible_runs(camera_with(400, 0), T, {.min_length_px = 0});
  const auto some = visibility.visible_runs(camera_with(400, 0), T, {.min_length_px = 10});
  ASSERT_EQ(all.size(), 5u);
  ASSERT_EQ(some.size(), 4u);  // the gap of 1 cm is 2 px wide
  for (int i = 0; i < 5; ++i) EXPECT_EQ(all[i].run, i);
  EXPECT_EQ(some[2].run, 3);
  EXPECT_NEAR(some[2].t0, 0.5 + 1.4 / 4, 1e-12);
}

TEST(Visibility, SeamsOfWallsDoNotLeakLight) {
  Draws draws({.seed = 44});
  for (int trial = 0; trial < 50; ++trial) {
    World world;  // a turned wall as a fan of triangles about an inner point, and lines behind
    const Pose T{rotation_from_vector({0, 0, draws.uniform(-0.6, 0.6)}), {0, 3, 0}};
    const Polygon border{{-9, 0, -9}, {0, 0, -9}, {9, 0, -9}, {9, 0, 1}, {9, 0, 9}, {-9, 0, 9}};
    const Vector3d hub(draws.uniform(-1, 1), 0, draws.uniform(-1, 1));
    for (std::size_t i = 0; i < border.size(); ++i) {
      add_surface(world, {T * hub, T * border[i], T * border[(i + 1) % border.size()]});
    }
    for (int i = 0; i < 200; ++i) {
      const Vector3d a = T * random_point(draws, {-2, 0.01, -2}, {2, 3, 2});
      world.segments.push_back({a, T * random_point(draws, {-2, 0.01, -2}, {2, 3, 2}), 0});
    }
    const Vector3d eye(draws.uniform(-1, 1), 0, draws.uniform(-1, 1));
    for (const Vector3d& spoke : border) {  // exactly behind the seams, up to rounding
      world.segments.push_back({eye + 1.2 * (T * hub - eye), eye + 1.2 * (T * spoke - eye), 0});
      world.corners.push_back({eye + 1.3 * (T * (hub + 0.1 * (spoke - hub)) - eye), 0});
    }
    world.corners.push_back({eye + 1.3 * (T * hub - eye), 0});
    const Visibility visibility(world);
    const Pose T_camera_world = looking_at(eye, {0, 3, 0});
    const VisibilityOptions options{.min_length_px = 0};
    EXPECT_TRUE(visibility.visible_runs(camera_with(300, -0.05), T_camera_world, options).empty());
    EXPECT_TRUE(
        visibility.visible_corners(camera_with(300, -0.05), T_camera_world, options).empty());
    for (const WorldCorner& c : world.corners) EXPECT_FALSE(visibility.sees(eye, c.position_m));
  }
}

TEST(Visibility, ALineInLineWithASingleEdgeIsSeen) {
  World world;  // the wall ends at x = 0, and the line stands in line with its end
  add_surface(world, wall(2, {{-3, -3}, {0, -3}, {0, 3}, {-3, 3}}));
  world.segments.push_back({{0, 4, 0}, {0, 4, 1}, 0});
  world.corners.push_back({{0, 4, 0.5}, 0});
  const Visibility visibility(world);
  const Pose T = looking_at({0, 0, 0.4}, {0, 2, 0.4});
  const auto runs = visibility.visible_runs(camera_with(400, 0), T);
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_TRUE(runs[0].t0 == 0 && runs[0].t1 == 1);
  EXPECT_EQ(visibility.visible_corners(camera_with(400, 0), T).size(), 1u);
  // The other half of the wall closes the sight, in its plane or another.
  for (double y : {2.0, 3.0}) {
    World closed = world;
    add_surface(closed, wall(y, {{0, -3}, {3, -3}, {3, 3}, {0, 3}}));
    EXPECT_TRUE(Visibility(closed).visible_runs(camera_with(400, 0), T).empty());
    EXPECT_TRUE(Visibility(closed).visible_corners(camera_with(400, 0), T).empty());
  }
}

double to_border(const Camera& camera, const Vector2d& pixel) {
  return std::min({std::abs(pixel[0] + 0.5), std::abs(pixel[1] + 0.5),
                   std::abs(pixel[0] - camera.size_px[0] + 0.5),
                   std::abs(pixel[1] - camera.size_px[1] + 0.5)});
}

TEST(Visibility, RunsEndOnTheImagesBorder) {
  Draws draws({.seed = 45});
  World world;
  for (int i = 0; i < 500; ++i) {
    const Vector3d a = random_point(draws, {-4, 1, -4}, {4, 5, 4});
    world.segments.push_back({a, random_point(draws, {-4, 1, -4}, {4, 5, 4}), 0});
  }
  Camera wide = camera_with(330, 0);
  wide.model = Fisheye4{};
  wide.parameters.resize(8);
  wide.parameters << 330, 1, 320, 240, -0.02, 0.003, 0, 0;
  Camera tangential = camera_with(450, 0);
  tangential.model = OpenCv5{};
  tangential.parameters.resize(9);
  tangential.parameters << 450, 1, 310, 250, -0.25, 0.08, 0.002, -0.003, -0.01;
  const Pose T = looking_at({0, -1, 0}, {0, 2, 0});
  for (const Camera& camera : {camera_with(500, -0.2), camera_with(350, 0.2), wide, tangential}) {
    const VisibilityOptions options{.near_m = 0.5, .far_m = 5.5, .min_length_px = 0};
    const auto runs = Visibility(world).visible_runs(camera, T, options);
    int on_border = 0;
    for (const VisibleRun& r : runs) {
      for (double t : {r.t0, r.t1}) {
        const Vector3d x = T * at(world.segments[r.segment], t);
        const double at_depth = std::min(std::abs(x.z() - 0.5), std::abs(x.z() - 5.5));
        if (t == 0 || t == 1 || at_depth < 1e-9) continue;
        EXPECT_LT(to_border(camera, project(camera, x)), 1e-8);
        ++on_border;
      }
    }
    EXPECT_GT(on_border, 100);
    expect_same({world, camera, T, options}, runs, 20);
  }
}

TEST(Visibility, ALineThatBowsOutOfTheImageIsSeenTwice) {
  const Camera camera = camera_with(500, -0.2);
  World world;  // just inside the image's left corners, so outside in between
  const double x = unproject(camera, {-0.5, 236})[0] - 0.03;
  world.segments.push_back({{x, 1, -0.6}, {x, 1, 0.6}, 0});
  const Pose T = looking_at({0, 0, 0}, {0, 1, 0});
  const VisibilityOptions options{.min_length_px = 1};
  const auto runs = Visibility(world).visible_runs(camera, T, options);
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].run, 0);
  EXPECT_EQ(runs[1].run, 1);
  expect_same({world, camera, T, options}, runs, 500);
}

TEST(Visibility, DepthsAreAlongTheAxis) {
  World world;
  world.segments.push_back({{0.1, -5, 0.05}, {0.1, 15, 0.05}, 0});
  const auto runs = Visibility(world).visible_runs(
      camera_with(500, 0), looking_at({0, 0, 0}, {0, 1, 0}), {.near_m = 2, .far_m = 8});
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_NEAR(runs[0].t0, 7.0 / 20, 1e-12);
  EXPECT_NEAR(runs[0].t1, 13.0 / 20, 1e-12);
}

TEST(Visibility, SurfacesWithoutAreaOrSeenEdgeOnHideNothing) {
  World world;
  world.segments.push_back({{-0.5, 4, 1}, {0.5, 4, 1}, 0});
  add_surface(world, {{-1, 2, 1}, {0, 2, 1}, {1, 2, 1}});
  add_surface(world, {{0, 2, 1}, {0, 2, 1}, {0, 2, 1}});
  add_surface(world, {{-1, 2, 1}, {1, 2, 1}});
  add_surface(world, {});
  add_surface(world, {{-1, 1, 1}, {1, 1, 1}, {1, 3, 1}, {-1, 3, 1}});  // in the eye's height
  add_surface(world, {{0, -1, 0}, {0, 1, 0}, {0, 1, 2}, {0, -1, 2}});  // the eye lies in it
  const auto runs =
      Visibility(world).visible_runs(camera_with(500, 0), looking_at({0, 0, 1}, {0, 4, 1}));
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_TRUE(runs[0].t0 == 0 && runs[0].t1 == 1);
}

TEST(Visibility, BadArgumentsAreNamed) {
  const World world;
  const Visibility visibility(world);
  const Pose T;
  EXPECT_TRUE(visibility.visible_runs(camera_with(500, 0), T).empty());
  EXPECT_THROW(visibility.visible_runs(camera_with(500, 0), T, {.near_m = 0}), Error);
  EXPECT_THROW(visibility.visible_runs(camera_with(500, 0), T, {.near_m = 3, .far_m = 2}), Error);
  EXPECT_THROW(visibility.visible_runs(camera_with(500, 0), T, {.surface_gap_m = -1}), Error);
  EXPECT_THROW(visibility.visible_runs(camera_with(500, -2), T), Error);  // folds in the image
  Camera short_of_one = camera_with(500, 0);
  short_of_one.parameters.conservativeResize(4);
  EXPECT_THROW(visibility.visible_runs(short_of_one, T), Error);
}

}  // namespace
}  // namespace vernier
