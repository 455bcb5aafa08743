// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "calib/error.h"
#include "calib/pose.h"
#include "calib/statistics/random.h"
#include "localise/place.h"
#include "sim/buildings/office.h"
#include "sim/import/camera_path.h"
#include "sim/import/imported_world.h"
#include "sim/import/mesh.h"
#include "sim/mesh_files/mesh_file.h"
#include "sim/noise_free_view.h"
#include "sim/world.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::sim;
using namespace vernier::sim::internal;
using test::error_message;
using test::Folder;

namespace {

using Eigen::Vector3d;

/// A reconstruction of an office as LIMAP and COLMAP leave it: lines with errors of a centimetre,
/// in a frame and a unit of its own, and the poses of the cameras that saw them.
struct Reconstruction {
  static constexpr double unit_m = 2.7;
  World world = build_world(make_office(3));
  Pose T_model_world{rotation_from_vector({0.9, -1.3, 0.4}), {3, -2, 5}};
  std::vector<std::pair<Vector3d, Vector3d>> lines;  ///< in the model
  std::vector<localise::Pose2D> places = drive_poses(world.route[0], 0.3, 0.3);

  Reconstruction() {
    RandomStream draws({.seed = 11});
    const auto in_model = [&](const Vector3d& x) -> Vector3d {
      const Vector3d error{draws.normal(), draws.normal(), draws.normal()};
      return T_model_world * Vector3d((x + 0.01 * error) / unit_m);
    };
    for (const WorldSegment& s : world.segments) {
      if ((s.b_m - s.a_m).norm() > 0.5) lines.emplace_back(in_model(s.a_m), in_model(s.b_m));
    }
  }

  static std::string numbers(const Vector3d& x) {
    return fmt::format("{:.10f} {:.10f} {:.10f}", x.x(), x.y(), x.z());
  }

  std::string all_tracks() const {
    std::string text = fmt::format("{}\n", lines.size());
    for (std::size_t i = 0; i < lines.size(); ++i) {
      // Every fifth is seen in three images only, one of them twice.
      const bool few = i % 5 == 0;
      text += fmt::format("{} {} {}\n{}\n{}\n{}\n{}\n", i, few ? 4 : 5, few ? 3 : 5,
                          numbers(lines[i].first), numbers(lines[i].second),
                          few ? "0 1 1 2 " : "0 1 2 3 4 ", few ? "7 8 9 10 " : "7 8 9 10 11 ");
    }
    return text;
  }

  std::string images() const {
    std::string text = "# Image list with two lines of data per image:\n";
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Pose T_camera_world = T_left_world(places[i], {1.3, 0.1});
      // x_camera / unit = R R_wm' x_model + …
      const Eigen::Matrix3d R = T_camera_world.R * T_model_world.R.transpose();
      const Vector3d t = T_camera_world.t / unit_m - R * T_model_world.t;
      const Eigen::Quaterniond q(R);
      text += fmt::format("{} {:.12f} {:.12f} {:.12f} {:.12f} {} 1 frame{:04}.png\n\n", i + 1,
                          q.w(), q.x(), q.y(), q.z(), numbers(t), i);
    }
    return text;
  }
};

TEST(LineTracks, ALevelledModelIsTheBuildingUpToItsHeading) {
  const Reconstruction made;
  const Folder folder;
  folder.write("images.txt", made.images());
  Mesh mesh = read_mesh(folder.write("alltracks.txt", made.all_tracks()));
  ASSERT_EQ(mesh.lines.size(), made.lines.size());
  std::vector<PathCamera> cameras = read_camera_path(folder.path());
  ASSERT_EQ(cameras.size(), made.places.size());
  const Vector3d up = up_of(cameras, mesh, "model");
  // Some hundred lines with errors of a centimetre each; the cameras alone would be 0.1 rad off.
  EXPECT_LT((up - made.T_model_world.R * Vector3d::UnitZ()).norm(), 2e-3);
  level(up, mesh, cameras);
  sim::internal::ImportOptions options;
  options.unit_m = Reconstruction::unit_m;
  options.floor_m = Reconstruction::unit_m * median_height(cameras) - 1.3;
  const ImportedWorld imported = import_world(mesh, options, "model");
  std::vector<double> heights, expected;
  for (const auto& [a, b] : imported.world.loose.segments_m) {
    if (std::abs(a.z() - b.z()) > 1.5) heights.push_back(std::max(a.z(), b.z()));
  }
  for (const WorldSegment& s : made.world.segments) {
    if (std::abs(s.a_m.z() - s.b_m.z()) > 1.5) expected.push_back(std::max(s.a_m.z(), s.b_m.z()));
  }
  ASSERT_GT(heights.size(), expected.size() * 9 / 10);
  std::nth_element(heights.begin(), heights.begin() + heights.size() / 2, heights.end());
  std::nth_element(expected.begin(), expected.begin() + expected.size() / 2, expected.end());
  EXPECT_NEAR(heights[heights.size() / 2], expected[expected.size() / 2], 0.06);

  const std::vector<RouteLeg> route =
      route_of(cameras, Reconstruction::unit_m, imported.report.moved_m);
  ASSERT_EQ(route.size(), 1u);
  EXPECT_NEAR(route_length_m(route), route_length_m({made.world.route[0]}), 0.3);
  EXPECT_LT(route[0].points_m.size(), 5u);  // a straight corridor
}

TEST(LineTracks, TheWayOfCamerasFollowsTheNumbersInTheirNames) {
  const Folder folder;
  folder.write("images.txt",
               "1 1 0 0 0 0 0 0 1 a10.jpg\n\n2 1 0 0 0 0 0 1 1 a9.jpg\n\n"
               "3 1 0 0 0 0 0 2 1 b1.jpg\n\n4 1 0 0 0 0 0 3 1 a009b.jpg\n\n");
  std::string names;
  for (const PathCamera& camera : read_camera_path(folder.path())) names += camera.name + " ";
  EXPECT_EQ(names, "a9.jpg a009b.jpg a10.jpg b1.jpg ");
}

TEST(LineTracks, OfFewImagesAreLeftOut) {
  const Reconstruction made;
  const Folder folder;
  const auto file = folder.write("alltracks.txt", made.all_tracks());
  const Mesh some = read_mesh(file, {{}, 4});
  EXPECT_EQ(some.parts_left_out, (made.lines.size() + 4) / 5);
  EXPECT_EQ(some.lines.size() + some.parts_left_out, made.lines.size());
  EXPECT_EQ(read_mesh(file, {{}, 3}).lines.size(), made.lines.size());
}

TEST(LineTracks, OfAFolderAreReadByTheirNumbers) {
  const Folder folder;
  folder.write("track_10.txt",
               "1 0 0 2 0 0 \n2 2\nimage_id_list 3 4 \nline_id_list 0 0 \nline2d_list\n1 2 3 4 \n5 "
               "6 7 8 \nEND\n");
  folder.write("track_2.txt", "0 0 0 0 1 0\n3 3\nimage_id_list 1 2 3\nline_id_list 0 0 0\n");
  folder.write("image_list.txt", "number of images, 5\n");
  const Mesh mesh = read_mesh(folder.path());
  ASSERT_EQ(mesh.lines.size(), 2u);
  EXPECT_EQ(mesh.vertices[1], Vector3d(0, 1, 0));
  EXPECT_EQ(mesh.vertices[2], Vector3d(1, 0, 0));
  EXPECT_EQ(read_mesh(folder.path(), {{}, 3}).lines.size(), 1u);
}

TEST(LineTracks, BadOnesAreNamed) {
  const Folder folder;
  const auto said = [&](const std::string& text) {
    return error_message([&] { read_mesh(folder.write("t.txt", text)); });
  };
  EXPECT_NE(said("2\n0 1 1\n0 0 0\n1 0 0\n0\n0\n").find("ends before track 1"), std::string::npos);
  EXPECT_NE(said("1\n0 1 1\n0 0\n1 0 0\n0\n0\n").find("t.txt:3: has 2 numbers"), std::string::npos);
  EXPECT_NE(said("1\n0 1 1\n0 0 x\n1 0 0\n0\n0\n").find("t.txt:3"), std::string::npos);
  EXPECT_NE(said("1\n0 1 1\n0 0 0\n1 0 0\n0\n0\n7\n").find("t.txt:7"), std::string::npos);
  EXPECT_NE(said("1\n0 5 3\n0 0 0\n1 0 0\n1\n0\n").find("t.txt:5: names 1"), std::string::npos);
  EXPECT_NE(said("1\n0 2 2\n0 0 0\n1 0 0\n7 7\n0 1\n").find("names 1 images, not 2"),
            std::string::npos);
  EXPECT_NE(said("1\n0 1 1\n0 0 0\n1 0 0\n-7\n0\n").find("negative image"), std::string::npos);
  EXPECT_EQ(read_mesh(folder.write("t.txt", "#edges\n0 0 0 1 0 0\n")).format, "list of lines");
  folder.write("track_0.txt", "0 0 0 1 1 1\n1 1\nlines 3\n");
  EXPECT_NE(error_message([&] { read_mesh(folder.path()); }).find("image_id_list"),
            std::string::npos);
  EXPECT_NE(error_message([&] {
              read_mesh(folder.write("lines.txt", "0 0 0 1 0 0\n"), {{}, 2});
            }).find("no line tracks"),
            std::string::npos);
  EXPECT_NE(error_message([&] { read_camera_path(folder.path()); }).find("images.txt"),
            std::string::npos);
  folder.write("images.bin", "x");
  EXPECT_NE(error_message([&] { read_camera_path(folder.path()); }).find("model_converter"),
            std::string::npos);
  folder.write("images.txt", "1 0.5 0 0 0 0 0 0 1 a.png\n\n");
  EXPECT_NE(error_message([&] { read_camera_path(folder.path()); }).find("quaternion"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
