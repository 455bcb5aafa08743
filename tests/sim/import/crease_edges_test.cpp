// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/import/crease_edges.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "sim/import/convex_faces.h"
#include "sim/import/mesh.h"
#include "tests/sim/import/made_meshes.h"

namespace vernier::sim::internal {
namespace {

using test::add_box;
using test::add_rectangle;

std::vector<double> lengths(const std::vector<Segment>& segments) {
  std::vector<double> all;
  for (const auto& [a, b] : segments) all.push_back((b - a).norm());
  std::sort(all.begin(), all.end());
  return all;
}

double area(const Polygon& polygon) {
  Eigen::Vector3d twice = Eigen::Vector3d::Zero();
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    twice += (polygon[i] - polygon[0]).cross(polygon[i + 1] - polygon[0]);
  }
  return 0.5 * twice.norm();
}

double area(const std::vector<Polygon>& polygons) {
  double sum = 0;
  for (const Polygon& polygon : polygons) sum += area(polygon);
  return sum;
}

// A box has twelve edges, into however many triangles its faces are cut.
TEST(CreaseEdges, OfABox) {
  for (const int pieces : {1, 2, 7}) {
    Mesh mesh;
    add_box(mesh, {1, 2, 3}, {2, 4, 6}, pieces);
    const auto found = lengths(crease_edges(welded(mesh, 5e-4)));
    const std::vector<double> wanted{1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
    ASSERT_EQ(found.size(), wanted.size()) << pieces;
    for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(found[i], wanted[i], 1e-9);
  }
}

// A plane whose parts have other vertices along their common line (T-junctions) has no edge there.
TEST(CreaseEdges, NoneInsideAPlaneOfUnmatchedParts) {
  Mesh mesh;
  add_rectangle(mesh, {0, 0, 0}, {4, 0, 0}, {0, 3, 0}, 5, 2);
  add_rectangle(mesh, {4, 0, 0}, {4, 0, 0}, {0, 3, 0}, 3, 7);
  add_rectangle(mesh, {0, 3, 0}, {8, 0, 0}, {0, 1, 0}, 1, 1);
  const auto found = lengths(crease_edges(welded(mesh, 5e-4)));
  ASSERT_EQ(found.size(), 4u);
  EXPECT_NEAR(found[0], 4, 1e-9);
  EXPECT_NEAR(found[3], 8, 1e-9);
}

// Where a wall stands on a floor there is an edge, although the floor goes on behind it.
TEST(CreaseEdges, WhereThreePlanesMeet) {
  Mesh mesh;
  add_rectangle(mesh, {0, 0, 0}, {4, 0, 0}, {0, 2, 0});
  add_rectangle(mesh, {0, 2, 0}, {4, 0, 0}, {0, 2, 0});
  add_rectangle(mesh, {0, 2, 0}, {4, 0, 0}, {0, 0, 1});
  EXPECT_EQ(crease_edges(welded(mesh, 5e-4)).size(), 8u);  // 4 + 3 of the borders, and the foot
}

TEST(CreaseEdges, CountFromTheGivenAngleOn) {
  for (const double degrees : {10.0, 19.0, 21.0, 60.0, 120.0, 170.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    Mesh mesh;
    add_rectangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    add_rectangle(mesh, {1, 0, 0}, {std::cos(angle), 0, std::sin(angle)}, {0, 1, 0});
    CreaseOptions options;
    options.crease_rad = 20 * std::numbers::pi / 180;
    const std::size_t borders = degrees < 0.3 ? 4 : 6;
    EXPECT_EQ(crease_edges(welded(mesh, 5e-4), options).size(), borders + (degrees > 20))
        << degrees;
  }
}

// Property: turning and moving a mesh does the same to its edges.
TEST(CreaseEdges, AreThoseOfTheMovedMesh) {
  Mesh mesh = test::house();
  const auto before = lengths(crease_edges(welded(mesh, 5e-4)));
  const Eigen::Isometry3d T = Eigen::Translation3d(30, -20, 5) *
                              Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
  for (Eigen::Vector3d& v : mesh.vertices) v = T * v;
  const auto after = lengths(crease_edges(welded(mesh, 5e-4)));
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(before[i], after[i], 1e-9);
}

// A column of 12 sides has an upright edge at each, of 30 degrees; one of 8 sides is meant so.
TEST(CreaseEdges, OfRoundColumnsAreCounted) {
  for (const int sides : {8, 12, 16, 24}) {
    Mesh mesh;
    for (int k = 0; k < sides; ++k) {
      const auto at = [&](int i) {
        const double angle = 2 * std::numbers::pi * i / sides;
        return Eigen::Vector3d(0.4 * std::cos(angle), 0.4 * std::sin(angle), 0);
      };
      test::add_rectangle(mesh, at(k), at(k + 1) - at(k), {0, 0, 2.5});
    }
    CreaseRemarks remarks;
    crease_edges(welded(mesh, 1e-4), {}, &remarks);
    const bool is_shallow = sides == 12 || sides == 16;
    EXPECT_EQ(remarks.shallow_uprights, is_shallow ? static_cast<std::size_t>(sides) : 0u) << sides;
  }
}

TEST(CreaseEdges, KeepTheLinesOfAFile) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 0, 1}};
  mesh.lines = {{0, 1}, {1, 2}, {2, 3}, {2, 3}};
  EXPECT_EQ(lengths(crease_edges(mesh)), (std::vector<double>{1, 2}));
}

// Property: faces that are joined keep the area, and their number falls to that of the planes.
TEST(ConvexFaces, KeepTheArea) {
  for (const int pieces : {1, 2, 4, 8}) {
    Mesh mesh;
    add_box(mesh, {0, 0, 0}, {4, 3, 2}, pieces);
    const std::vector<Polygon> faces = convex_faces(welded(mesh, 5e-4));
    EXPECT_NEAR(area(faces), 2 * (12 + 8 + 6), 1e-9);
    EXPECT_EQ(faces.size(), 6u) << pieces;
  }
  const Mesh whole = welded(test::house(), 5e-4);
  double triangles = 0;
  for (const auto& [a, b, c] : whole.triangles) {
    triangles += area(Polygon{whole.vertices[a], whole.vertices[b], whole.vertices[c]});
  }
  EXPECT_NEAR(area(convex_faces(whole)), triangles, 1e-6);
}

TEST(ConvexFaces, AreNotJoinedAroundANotch) {
  Mesh mesh;  // an L
  add_rectangle(mesh, {0, 0, 0}, {2, 0, 0}, {0, 1, 0});
  add_rectangle(mesh, {0, 1, 0}, {1, 0, 0}, {0, 1, 0});
  const std::vector<Polygon> faces = convex_faces(welded(mesh, 5e-4));
  EXPECT_NEAR(area(faces), 3, 1e-9);
  EXPECT_EQ(faces.size(), 2u);
}

TEST(ConvexFaces, AreCutAtHeights) {
  const Polygon square{{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}};
  EXPECT_NEAR(area(between(square, 0.25, 0.5)), 0.25, 1e-12);
  EXPECT_NEAR(area(between(square, -1, 2)), 1, 1e-12);
  EXPECT_TRUE(between(square, 1.5, 2).empty());
  const auto [a, b] = between(Segment{{0, 0, 0}, {0, 2, 2}}, 0.5, 1.5);
  EXPECT_NEAR((b - a).norm(), std::sqrt(2.0), 1e-12);
  const auto [c, d] = between(Segment{{0, 0, 0}, {0, 2, 2}}, 3, 4);
  EXPECT_EQ((d - c).norm(), 0);
}

}  // namespace
}  // namespace vernier::sim::internal
