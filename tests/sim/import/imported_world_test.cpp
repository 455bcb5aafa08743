// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/import/imported_world.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <string>

#include "calib/statistics/random.h"
#include "sim/import/mesh.h"
#include "sim/study/upright_edges.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "tests/sim/import/made_meshes.h"
#include "tests/support/error_message.h"

namespace vernier::sim::internal {
namespace {

using test::add_rectangle;
using test::turned_and_scaled;
using test::two_storeys;
using vernier::test::error_message;

// However finely the walls are cut.
TEST(Storeys, AreFoundInFineMeshes) {
  Mesh mesh;
  for (const double z : {0.0, 3.0}) {
    add_rectangle(mesh, {0, 0, z}, {12, 0, 0}, {0, 8, 0}, 24, 16);
    add_rectangle(mesh, {0, 0, z}, {12, 0, 0}, {0, 0, 2.7}, 24, 6);
    add_rectangle(mesh, {12, 8, z}, {-12, 0, 0}, {0, 0, 2.7}, 24, 6);
    add_rectangle(mesh, {0, 8, z}, {0, -8, 0}, {0, 0, 2.7}, 16, 6);
    add_rectangle(mesh, {12, 0, z}, {0, 8, 0}, {0, 0, 2.7}, 16, 6);
  }
  const ImportedWorld imported = import_world(mesh, {}, "m.obj");
  EXPECT_EQ(imported.report.axes.up_axis, 2);
  EXPECT_EQ(imported.report.storeys_m.size(), 2u);
  EXPECT_EQ(imported.world.loose.segments_m.size(), 12u);
}

TEST(ImportedWorld, RefusesWhatItsReaderRounded) {
  Mesh mesh = test::house();
  mesh.step = 0.25;
  EXPECT_NE(error_message([&] { import_world(mesh, {}, "m.obj"); }).find("rounds to 0.25 m"),
            std::string::npos);
}

// What no face and no line has belongs to no building.
TEST(ImportedWorld, IsTheSameWithUnusedVertices) {
  Mesh mesh = test::house();
  const ImportedWorld plain = import_world(mesh, {}, "m.obj");
  mesh.vertices.insert(mesh.vertices.begin(), {{0, 0, 100}, {5000, 0, 0}});
  mesh.vertices.emplace_back(0, -700, 3);
  for (auto& triangle : mesh.triangles) {
    for (std::uint32_t& i : triangle) i += 2;
  }
  const ImportedWorld other = import_world(mesh, {}, "m.obj");
  EXPECT_EQ(other.report.axes.unit_m, 1);
  EXPECT_EQ(other.report.vertices, plain.report.vertices + 3);
  EXPECT_EQ(other.world.loose.segments_m, plain.world.loose.segments_m);
  EXPECT_EQ(other.report.moved_m, plain.report.moved_m);
}

// Property: unit, axis, and where a building stands change nothing but the plan's origin.
TEST(ImportedWorld, IsTheSameInAnyUnitAndAxis) {
  const ImportedWorld plain = import_world(test::house(), {}, "m.obj");
  EXPECT_EQ(plain.report.outside, 0u);
  EXPECT_GE(plain.world.loose.segments_m.size(), 45u);
  for (const int up : {0, 1, 2}) {
    for (const double unit : {1.0, 0.001}) {
      const ImportedWorld other =
          import_world(turned_and_scaled(test::house(), up, unit), {}, "m.obj");
      ASSERT_EQ(other.world.loose.segments_m.size(), plain.world.loose.segments_m.size());
      EXPECT_EQ(other.world.loose.surfaces_m.size(), plain.world.loose.surfaces_m.size());
    }
  }
  Mesh far = test::house();
  for (Eigen::Vector3d& v : far.vertices) v += Eigen::Vector3d(512'000, -4'000'000, 120);
  const ImportedWorld moved = import_world(far, {}, "m.obj");
  EXPECT_EQ(moved.world.loose.segments_m.size(), plain.world.loose.segments_m.size());
  EXPECT_NEAR(moved.report.moved_m.x(), 512'000, 1);
  EXPECT_NEAR(moved.report.floor_m, 120, 1e-6);
}

Mesh leaning(Mesh mesh, double degrees, const Eigen::Vector3d& about) {
  const Eigen::AngleAxisd lean(degrees * std::numbers::pi / 180, about.normalized());
  for (Eigen::Vector3d& v : mesh.vertices) v = lean * v;
  return mesh;
}

int count_upright(const WorldDescription& world) {
  return static_cast<int>(
      std::count_if(world.loose.segments_m.begin(), world.loose.segments_m.end(),
                    [](const auto& segment) { return is_upright(segment.first, segment.second); }));
}

// Property: a building out of level is the one in level, and says so.
TEST(ImportedWorld, IsLevelledIfFloorAndWallsLean) {
  ImportOptions options;
  options.up_axis = 2;
  options.unit_m = 1;
  const ImportedWorld plain = import_world(test::house(), options, "m.obj");
  EXPECT_EQ(plain.report.levelled_deg, 0);
  EXPECT_EQ(plain.report.floor_slope_deg, 0);
  EXPECT_EQ(plain.report.made_upright, 0u);
  for (const double degrees : {0.005, 0.05, 0.4, 2.5}) {
    for (const Eigen::Vector3d& about :
         {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(1, -2, 0)}) {
      const ImportedWorld other =
          import_world(leaning(test::house(), degrees, about), options, "m.obj");
      EXPECT_NEAR(other.report.levelled_deg, degrees < 0.02 ? 0 : degrees, 1e-3);
      EXPECT_EQ(other.report.floor_slope_deg, 0);
      EXPECT_EQ(other.world.loose.segments_m.size(), plain.world.loose.segments_m.size());
      EXPECT_EQ(count_upright(other.world), count_upright(plain.world)) << degrees;
    }
  }
}

TEST(ImportedWorld, IsNotLevelledWhereHeightsAreGiven) {
  const Mesh mesh = leaning(test::house(), 0.4, {0, 1, 0});
  ImportOptions options;
  options.up_axis = 2;
  options.unit_m = 1;
  EXPECT_GT(import_world(mesh, options, "m.obj").report.levelled_deg, 0.3);
  options.is_level = true;
  EXPECT_EQ(import_world(mesh, options, "m.obj").report.levelled_deg, 0);
  options.is_level = false;
  options.floor_m = 0;
  EXPECT_EQ(import_world(mesh, options, "m.obj").report.levelled_deg, 0);
}

// Edges of walls that lean by more than rounding stay at them: made upright they would be hidden.
TEST(ImportedWorld, EdgesStayAtTheirSurfaces) {
  constexpr double sheared = 0.0049;  // 0.28 degrees: 6 mm at each end of a wall
  const double gap_m = VisibilityOptions().surface_gap_m;
  Mesh mesh = test::house();
  for (Eigen::Vector3d& v : mesh.vertices) v.x() += sheared * v.z();
  ImportOptions options;
  options.up_axis = 2;
  options.unit_m = 1;
  const ImportedWorld imported = import_world(mesh, options, "m.obj");
  ASSERT_EQ(imported.report.levelled_deg, 0);
  const FeatureSet& features = imported.world.loose;
  for (const auto& [a, b] : features.segments_m) {
    for (const Eigen::Vector3d& end : {a, b}) {
      double nearest_m = 1e9;
      for (const Polygon& surface : features.surfaces_m) {
        for (const Eigen::Vector3d& corner : surface) {
          nearest_m = std::min(nearest_m, (corner - end).norm());
        }
      }
      EXPECT_LT(nearest_m, gap_m) << end.transpose();
    }
  }
  for (const Eigen::Vector3d& corner : features.corners_m) {
    const auto ends = std::count_if(
        features.segments_m.begin(), features.segments_m.end(), [&](const Segment& segment) {
          return std::min((segment.first - corner).norm(), (segment.second - corner).norm()) <
                 gap_m;
        });
    EXPECT_GE(ends, 2) << corner.transpose();
  }
}

// A floor that rises between upright walls stays as it is, and is told.
TEST(ImportedWorld, IsNotLevelledByARamp) {
  Mesh mesh = test::house(0, false);
  add_rectangle(mesh, {0, 0, 0}, {8.1, 0, 0.3}, {0, 3, 0});
  add_rectangle(mesh, {0, 0, 2.1}, {8.1, 0, 0.3}, {0, 3, 0});
  ImportOptions options;
  options.up_axis = 2;
  options.unit_m = 1;
  const ImportReport report = import_world(mesh, options, "m.obj").report;
  EXPECT_EQ(report.levelled_deg, 0);
  EXPECT_NEAR(report.floor_slope_deg, std::atan2(0.3, 8.1) * 180 / std::numbers::pi, 1e-3);
}

// Property: a building that was turned and written in whole millimetres has the edges of the one
// before, though rounding turns its short pieces by degrees; round things stay round.
TEST(ImportedWorld, IsTheSameInWholeMillimetres) {
  Mesh mesh = test::house();
  for (int i = 0; i < 40; ++i) {  // pieces of walls, whose corners cut its edges into short pieces
    add_rectangle(mesh, {0.2 * i, 0, 0}, {0.2, 0, 0}, {0, 0, 0.03 + 0.01 * (i % 3)});
  }
  mesh = turned_and_scaled(leaning(mesh, 33, {0, 0, 1}), 2, 1);
  ImportOptions options;
  options.up_axis = 2;
  options.unit_m = 1;
  const ImportedWorld exact = import_world(mesh, options, "m.obj");
  for (Eigen::Vector3d& v : mesh.vertices) v = (v * 1000).array().round() / 1000;
  const ImportedWorld rounded = import_world(mesh, options, "m.obj");
  EXPECT_EQ(rounded.report.edges, exact.report.edges);
  EXPECT_EQ(rounded.world.loose.segments_m.size(), exact.world.loose.segments_m.size());
  // A bow of 1 m radius in pieces of 0.2 m.
  Mesh bow = test::house();
  for (int i = 0; i < 15; ++i) {
    const auto at = [](int k) { return Eigen::Vector3d(std::sin(0.2 * k), std::cos(0.2 * k), 1); };
    bow.lines.push_back({static_cast<std::uint32_t>(bow.vertices.size()),
                         static_cast<std::uint32_t>(bow.vertices.size() + 1)});
    for (const int k : {i, i + 1}) bow.vertices.push_back((at(k) * 1000).array().round() / 1000);
  }
  EXPECT_EQ(import_world(bow, options, "m.obj").report.edges,
            import_world(test::house(), options, "m.obj").report.edges + 15);
}

// Vertices that jitter by a third of a millimetre leave no edge exactly upright.
TEST(ImportedWorld, NearlyUprightEdgesBecomeUpright) {
  Mesh mesh = test::house();
  vernier::internal::RandomStream draws({.seed = 4});
  std::map<std::array<double, 3>, Eigen::Vector3d> moved;
  for (Eigen::Vector3d& v : mesh.vertices) {
    const auto [at, is_new] = moved.try_emplace({v.x(), v.y(), v.z()});
    if (is_new) at->second = v + 1e-4 * Eigen::Vector3d{draws.normal(), draws.normal(), 0};
    v = at->second;
  }
  ImportOptions options;
  const ImportedWorld snapped = import_world(mesh, options, "m.obj");
  options.upright_deg = 0;
  const ImportedWorld kept = import_world(mesh, options, "m.obj");
  EXPECT_EQ(kept.report.made_upright, 0u);
  EXPECT_GT(snapped.report.made_upright, 20u);
  EXPECT_GE(count_upright(snapped.world),
            count_upright(import_world(test::house(), {}, "m.obj").world) - 1);
  EXPECT_LT(count_upright(kept.world), 8);
  EXPECT_EQ(snapped.world.loose.segments_m.size(), kept.world.loose.segments_m.size());
  for (std::size_t i = 0; i < kept.world.loose.segments_m.size(); ++i) {
    const Segment &was = kept.world.loose.segments_m[i], &is = snapped.world.loose.segments_m[i];
    EXPECT_LT((was.first - is.first).norm() + (was.second - is.second).norm(), 2e-3);
  }
}

TEST(ImportedWorld, IsOneStorey) {
  ImportOptions options;
  options.up_axis = 2;
  options.unit_m = 1;
  const ImportedWorld lower = import_world(two_storeys(), options, "m.obj");
  options.storey = 2;
  const ImportedWorld upper = import_world(two_storeys(), options, "m.obj");
  for (const ImportedWorld* world : {&lower, &upper}) {
    double low = 1e9, high = -1e9;
    for (const auto& [a, b] : world->world.loose.segments_m) {
      low = std::min({low, a.z(), b.z()});
      high = std::max({high, a.z(), b.z()});
    }
    EXPECT_NEAR(low, 0, 0.02);
    EXPECT_LT(high, 3);
  }
  EXPECT_NEAR(upper.report.floor_m, 3, 1e-9);
  EXPECT_GT(lower.report.outside, 0u);
  EXPECT_EQ(lower.report.below, 0u);
  EXPECT_GT(upper.report.below, 0u);
  EXPECT_EQ(upper.report.below, upper.report.outside);
  options.storey = 3;
  EXPECT_EQ(error_message([&] { import_world(two_storeys(), options, "m.obj"); }),
            "m.obj: has 2 storeys, and no storey 3; give one of them, or the floor's height");
}

TEST(ImportedWorld, RefusesWhatIsNone) {
  EXPECT_EQ(error_message([] { import_world({}, {}, "m.obj"); }),
            "m.obj: holds no triangles and no lines; export the geometry of a building");
  Mesh bad = test::house();
  bad.vertices[5].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(error_message([&] { import_world(bad, {}, "m.obj"); }),
            "m.obj: vertex 5 is not finite; correct it, or export again");
}

}  // namespace
}  // namespace vernier::sim::internal
