// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/visibility.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <thread>

#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/statistics/random.h"
#include "sim/buildings/office.h"
#include "sim/visibility/convex_pieces.h"
#include "sim/visibility/near_occluders.h"
#include "sim/visibility/shadow.h"
#include "sim/visibility/shadow_grid.h"
#include "sim/visibility/view_frustum.h"
#include "sim/world.h"
#include "tests/support/point_visibility.h"
#include "tests/support/walls_and_boxes.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

using namespace test;

Vector3d at(const WorldSegment& s, double t) { return s.a_m + t * (s.b_m - s.a_m); }

std::vector<VisibleInterval> runs_of(const std::vector<VisibleInterval>& runs, int segment) {
  std::vector<VisibleInterval> own;
  for (const VisibleInterval& run : runs) {
    if (run.segment == segment) own.push_back(run);
  }
  return own;
}

/// Distance in t to the nearest end of a run.
double to_nearest_end(const std::vector<VisibleInterval>& runs, double t) {
  double least = 1;
  for (const VisibleInterval& r : runs) {
    least = std::min({least, std::abs(t - r.t0), std::abs(t - r.t1)});
  }
  return least;
}

bool in_runs(const std::vector<VisibleInterval>& runs, double t) {
  for (const VisibleInterval& r : runs) {
    if (t >= r.t0 && t <= r.t1) return true;
  }
  return false;
}

/// Compares runs with the oracle: samples, changes between samples to 1e-6, and both sides of ends.
void expect_same(const Oracle& oracle, const std::vector<VisibleInterval>& runs, int samples) {
  for (int i = 0; i < static_cast<int>(oracle.world.segments.size()); ++i) {
    const WorldSegment& segment = oracle.world.segments[i];
    const std::vector<VisibleInterval> own = runs_of(runs, i);
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
    for (const VisibleInterval& r : own) {
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

TEST(Visibility, AgreesWithDenseRaysInRandomWorlds) {
  const std::vector<Camera> cameras{camera_with(525, 0), camera_with(500, -0.2),
                                    camera_with(420, -0.1), camera_with(480, 0.15)};
  for (std::uint32_t trial = 0; trial < 4; ++trial) {
    RandomStream draws({.seed = 41, .trial = trial});
    const World world = random_world(draws);
    const Visibility visibility(world);
    for (const Camera& camera : cameras) {
      const Vector3d eye = random_point(draws, {-3, -3, 0.5}, {3, 3, 2});
      const Pose T = looking_at(eye, random_point(draws, {-2, -2, 0.5}, {2, 2, 1.5}));
      const VisibilityOptions options{.far_m = 6, .min_length_px = 0};
      const Oracle oracle{world, camera, T, options};
      expect_same(oracle, visibility.visible_intervals(camera, T, options), 60);
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
  RandomStream draws({.seed = 42});
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

Vector3d lattice_point(RandomStream& draws, std::uint32_t n) {
  const double x = draws.below(n), y = draws.below(n);
  return {x, y, static_cast<double>(draws.below(n))};
}

World lattice_world(RandomStream& draws) {
  World world;
  const auto lattice = [&](std::uint32_t n) { return lattice_point(draws, n); };
  for (int i = 0; i < 6; ++i) {
    const Vector3d at = lattice(5);
    add_box(world, {Eigen::Matrix3d::Identity(), at}, lattice(2) + Vector3d(1, 1, 1));
    const Vector3d p = lattice(5), q = lattice(5), u = lattice(3), v = lattice(3);
    add_surface(world, {p, q, lattice(5)}, true);
    add_surface(world, {q, q + u, q + u + v, q + v});
    add_surface(world, {q, q + v, q - u + v, q - u});  // shares an edge with the one above
  }
  for (int i = 0; i < 20; ++i) {
    const Vector3d a = lattice(7), b = lattice(7), c = lattice(7);
    world.segments.push_back({a, b, 0});
    world.corners.push_back({(c + a) / 2, 0});
  }
  return world;
}

TEST(Visibility, RunsAgreeWithPointsInAWorldFullOfCoincidences) {
  // Everything on a small lattice: eyes in planes, lines in line with edges, seams behind seams.
  RandomStream draws({.seed = 46});
  int seen = 0, hidden = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const World world = lattice_world(draws);
    const Visibility visibility(world);
    const Vector3d eye = lattice_point(draws, 7) + Vector3d(0, -3, 0);
    const Pose T = looking_at(eye, lattice_point(draws, 5) + Vector3d(0, 6, 0));
    const Camera camera = camera_with(300, 0);
    const VisibilityOptions options{.near_m = 0.01, .min_length_px = 0};
    const auto corners = visibility.visible_corners(camera, T, options);
    for (int i = 0; i < static_cast<int>(world.corners.size()); ++i) {
      const Vector3d x = world.corners[i].position_m, x_camera = T * x;
      if (x_camera.z() < 0.011 || !in_image(camera, project(camera, x_camera))) continue;
      EXPECT_EQ(visibility.sees(eye, x, options),
                std::count(corners.begin(), corners.end(), i) == 1)
          << "trial " << trial << " corner " << i;
    }
    const auto runs = visibility.visible_intervals(camera, T, options);
    for (int i = 0; i < static_cast<int>(world.segments.size()); ++i) {
      const WorldSegment& segment = world.segments[i];
      if ((segment.a_m - eye).cross(segment.b_m - eye).norm() < 1e-9) continue;  // seen end-on
      const auto own = runs_of(runs, i);
      for (double t : {0.0711, 0.2419, 0.4373, 0.6397, 0.8171, 0.9613}) {
        const Vector3d x = at(segment, t), x_camera = T * x;
        if (x_camera.z() < 0.011 || !in_image(camera, project(camera, x_camera))) continue;
        const bool sees = visibility.sees(eye, x, options);
        EXPECT_EQ(sees, in_runs(own, t)) << "trial " << trial << " segment " << i << " at " << t;
        ++(sees ? seen : hidden);
      }
    }
  }
  EXPECT_GT(seen, 1000);
  EXPECT_GT(hidden, 1000);
}

double to_border(const Camera& camera, const Vector2d& pixel) {
  return std::min({std::abs(pixel[0] + 0.5), std::abs(pixel[1] + 0.5),
                   std::abs(pixel[0] - camera.size_px[0] + 0.5),
                   std::abs(pixel[1] - camera.size_px[1] + 0.5)});
}

TEST(Visibility, RunsEndOnTheImagesBorder) {
  RandomStream draws({.seed = 45});
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
    const auto runs = Visibility(world).visible_intervals(camera, T, options);
    int on_border = 0;
    for (const VisibleInterval& r : runs) {
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
  const auto runs = Visibility(world).visible_intervals(camera, T, options);
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].run, 0);
  EXPECT_EQ(runs[1].run, 1);
  expect_same({world, camera, T, options}, runs, 500);
}

/// The visible runs with the shadows of all surfaces and a look at all segments.
std::vector<VisibleInterval> runs_among_all(const World& world,
                                            const ViewFrustum& frustum,
                                            const Pose& T,
                                            double gap_m) {
  const ConvexSurfaces surfaces = convex_surfaces(world);
  std::vector<int> pieces(surfaces.pieces.size());
  std::iota(pieces.begin(), pieces.end(), 0);
  ShadowGrid grid;
  grid.build(surfaces, pieces, T, frustum, gap_m);
  std::vector<VisibleInterval> runs;
  std::vector<OccludedInterval> hidden;
  std::vector<Stretch> inside, unhidden;
  for (int i = 0; i < static_cast<int>(world.segments.size()); ++i) {
    const Vector3d a = T * world.segments[i].a_m, b = T * world.segments[i].b_m;
    Stretch open;
    if (!frustum.clip(a, b, open) || !grid.hide(a, b, open, hidden)) continue;
    frustum.in_image(a, b, open, inside);
    subtract_intervals(open, hidden, unhidden);
    int run = 0;
    for (const Stretch& u : unhidden) {
      for (const Stretch& v : inside) {
        const double t0 = std::max(u.t0, v.t0), t1 = std::min(u.t1, v.t1);
        if (t1 - t0 > min_stretch) runs.push_back({i, run++, t0, t1});
      }
    }
  }
  return runs;
}

TEST(Visibility, LeavingOutWhatIsOutsideTheViewChangesNoBit) {
  RandomStream draws({.seed = 43});
  int left_out = 0, runs = 0;
  for (int trial = 0; trial < 150; ++trial) {
    const World world = random_world(draws);
    const Camera camera = camera_with(450, trial % 3 == 0 ? 0 : trial % 3 == 1 ? -0.2 : 0.15);
    const VisibilityOptions options{.far_m = 6, .min_length_px = 0};
    const ViewFrustum frustum(camera, options.near_m, options.far_m);
    const Vector3d eye = random_point(draws, {-3, -3, 0.5}, {3, 3, 2});
    const Pose T = looking_at(eye, random_point(draws, {-2, -2, 0.5}, {2, 2, 1.5}));
    const ViewVolume volume = frustum.volume(T);
    for (const WorldSegment& s : world.segments) {
      left_out += !volume.may_meet({s.a_m.cwiseMin(s.b_m), s.a_m.cwiseMax(s.b_m)});
    }
    const auto expected = runs_among_all(world, frustum, T, options.surface_gap_m);
    const auto found = Visibility(world).visible_intervals(camera, T, options);
    ASSERT_EQ(found.size(), expected.size());
    runs += static_cast<int>(found.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].segment, expected[i].segment);
      EXPECT_EQ(found[i].run, expected[i].run);
      EXPECT_EQ(found[i].t0, expected[i].t0);
      EXPECT_EQ(found[i].t1, expected[i].t1);
    }
  }
  EXPECT_GT(left_out, 1000);
  EXPECT_GT(runs, 1000);
}

// Walls hide most of an office: what hides behind one of them is never looked at.
TEST(Visibility, LeavingOutWhatAWallHidesChangesNoBit) {
  const World world = build_world(make_office(3));
  const Visibility visibility(world);
  const Camera camera = camera_with(525, -0.05);
  const VisibilityOptions options{.min_length_px = 0};
  const ViewFrustum frustum(camera, options.near_m, options.far_m);
  const ConvexSurfaces surfaces = convex_surfaces(world);
  const LargeSurfaces large(surfaces);
  NearOccluders occluders;
  std::size_t in_view = 0, hidden = 0, runs = 0;
  for (int i = 0; i < 12; ++i) {
    const RoutePoint at = route_point(world.route, 1 + 7.0 * i);
    const Vector3d eye(at.pose.x_m, at.pose.y_m, 1.2);
    const Pose T = looking_at(eye, eye + Vector3d(std::cos(i), std::sin(i), 0));
    const ViewVolume volume = frustum.volume(T);
    occluders.choose(surfaces, large, eye, volume, options.surface_gap_m);
    for (const WorldSegment& s : world.segments) {
      const Eigen::AlignedBox3d box(s.a_m.cwiseMin(s.b_m), s.a_m.cwiseMax(s.b_m));
      if (!volume.may_meet(box)) continue;
      ++in_view;
      hidden += occluders.hide(box);
    }
    const auto expected = runs_among_all(world, frustum, T, options.surface_gap_m);
    const auto found = visibility.visible_intervals(camera, T, options);
    ASSERT_EQ(found.size(), expected.size());
    runs += found.size();
    for (std::size_t k = 0; k < found.size(); ++k) {
      ASSERT_EQ(found[k].segment, expected[k].segment);
      ASSERT_EQ(found[k].run, expected[k].run);
      ASSERT_EQ(found[k].t0, expected[k].t0);
      ASSERT_EQ(found[k].t1, expected[k].t1);
    }
    // Asking for some segments gives their part of the answer.
    std::vector<int> some;
    for (int k = i; k < static_cast<int>(world.segments.size()); k += 3) some.push_back(k);
    const auto of_some = visibility.visible_intervals_of(some, camera, T, options);
    std::size_t next = 0;
    for (const VisibleInterval& run : found) {
      if (run.segment % 3 != i % 3 || run.segment < i) continue;
      ASSERT_LT(next, of_some.size());
      EXPECT_EQ(of_some[next].segment, run.segment);
      EXPECT_EQ(of_some[next].t0, run.t0);
      EXPECT_EQ(of_some[next++].t1, run.t1);
    }
    EXPECT_EQ(next, of_some.size());
  }
  EXPECT_GT(runs, 1000u);
  EXPECT_GT(hidden, in_view / 2);
}

TEST(Visibility, ThreadsMayShareIt) {
  RandomStream draws({.seed = 47});
  const World world = random_world(draws);
  const Visibility visibility(world);
  const Camera camera = camera_with(500, -0.1);
  const auto look = [&](int i) {
    const double heading = 0.7 * i;
    const Vector3d eye(0.2, 0.1, 1.2);
    const Pose T = looking_at(eye, eye + Vector3d(std::cos(heading), std::sin(heading), 0));
    std::vector<double> ends;
    for (const VisibleInterval& r : visibility.visible_intervals(camera, T)) {
      ends.insert(ends.end(), {static_cast<double>(r.segment), r.t0, r.t1});
    }
    return ends;
  };
  std::vector<std::vector<double>> alone(8), together(8);
  for (int i = 0; i < 8; ++i) alone[i] = look(i);
  std::vector<std::thread> threads;
  for (int k = 0; k < 4; ++k) {
    threads.emplace_back([&, k] {
      for (int i = k; i < 8; i += 4) together[i] = look(i);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(alone, together);
}

}  // namespace
}  // namespace vernier
