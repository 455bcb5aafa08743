// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/views/camera_poses.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/pose.h"
#include "localise/trajectory.h"
#include "tests/support/data_folder.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"

namespace vernier::localise::internal {
namespace {

using test::error_message;
using test::Folder;

std::vector<Pose> some_poses() {
  std::vector<Pose> poses;
  for (int i = 0; i < 4; ++i) {
    poses.push_back({rotation_from_vector({0.1 * i, 1.1 * i, -0.3}), {i / 3.0, 2, -7.0 + i}});
  }
  return poses;
}

std::string matrix_row(const std::string& name, const Pose& T) {
  std::string line = name;
  for (int r = 0; r < 3; ++r) {
    line += fmt::format(",{},{},{},{}", T.R(r, 0), T.R(r, 1), T.R(r, 2), T.t[r]);
  }
  return line + ",0,0,0,1\n";
}

std::string table() {
  std::string text = "frame,t00,t01,t02,t03,t10,t11,t12,t13,t20,t21,t22,t23,t30,t31,t32,t33\n";
  const std::vector<Pose> poses = some_poses();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    text += matrix_row(fmt::format("{:05}", 3 * i), poses[i]);
  }
  return text;
}

std::string colmap_text() {
  std::string text = "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n";
  const std::vector<Pose> poses = some_poses();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Pose T = poses[i].inverse();
    const Eigen::Quaterniond q(T.R);
    text += fmt::format("{} {} {} {} {} {} {} {} 1 walk/{:05}.png\n\n", i + 1, q.w(), q.x(), q.y(),
                        q.z(), T.t.x(), T.t.y(), T.t.z(), 3 * i);
  }
  return text;
}

std::string asl_text() {
  std::string text = "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x []\n";
  const std::vector<Pose> poses = some_poses();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Eigen::Quaterniond q(poses[i].R);
    const Eigen::Vector3d& t = poses[i].t;
    text +=
        fmt::format("{},{},{},{},{},{},{},{},0.1,0.2,0.3\n", 1403715273000000000 + i * 100000000,
                    t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z());
  }
  return text;
}

void expect_same(const Pose& a, const Pose& b, double tolerance = 1e-12) {
  EXPECT_LT((a.R - b.R).norm(), tolerance);
  EXPECT_LT((a.t - b.t).norm(), tolerance);
}

TEST(CameraPoses, NamedPosesAreFoundByName) {
  const Folder folder;
  const std::vector<Pose> poses = some_poses();
  for (const auto& file :
       {folder.write("poses.csv", table()), folder.write("images.txt", colmap_text())}) {
    const CameraPoses read = read_camera_poses(file);
    ASSERT_EQ(read.poses.size(), poses.size());
    EXPECT_FALSE(read.of_body);
    const std::vector<Pose> found =
        poses_of_images(read, {"b/00009.png", "00000.jpg", "00006.png"}, "poses");
    if (file.filename() == "poses.csv") {
      ASSERT_EQ(found.size(), 3u);
      expect_same(found[0], poses[3]);
      expect_same(found[1], poses[0]);
      expect_same(found[2], poses[2]);
    }
    const std::string said = error_message([&] { poses_of_images(read, {"00001.png"}, "poses"); });
    EXPECT_NE(said.find("has no pose of \"00001.png\""), std::string::npos) << said;
  }
  const CameraPoses of_folder = read_camera_poses(folder.path());
  EXPECT_EQ(of_folder.poses[1].image, "walk/00003.png");
  expect_same(of_folder.poses[1].T_world_camera, poses[1]);
}

TEST(CameraPoses, TimesBetweenTwoAreInterpolated) {
  const Folder folder;
  const CameraPoses read = read_camera_poses(folder.write("data.csv", asl_text()));
  ASSERT_TRUE(read.of_body);
  const std::vector<Pose> poses = some_poses();
  const std::vector<Pose> found = poses_of_images(
      read, {"1403715273000000000.png", "1403715273050000000.png", "1403715273300000000.png"}, "d");
  expect_same(found[0], poses[0], 1e-6);
  expect_same(found[2], poses[3], 1e-6);
  expect_same(
      {found[1].R, found[1].t},
      {Eigen::Quaterniond(poses[0].R).slerp(0.5, Eigen::Quaterniond(poses[1].R)).toRotationMatrix(),
       (poses[0].t + poses[1].t) / 2},
      1e-5);
  for (const char* outside : {"1403715272900000000.png", "1403715273400000000.png"}) {
    const std::string said = error_message([&] { poses_of_images(read, {outside}, "data.csv"); });
    EXPECT_NE(said.find("has no pose at the time"), std::string::npos) << said;
  }
  const std::string said =
      error_message([&] { poses_of_images(read, {"1403715273050000000.png"}, "d", 0.05); });
  EXPECT_NE(said.find("has no pose at the time"), std::string::npos) << said;
}

TEST(CameraPoses, OrderCountsWhereNothingElseDoes) {
  const Folder folder;
  std::string joined;
  for (const Pose& T : some_poses()) {
    for (int r = 0; r < 3; ++r) {
      joined += fmt::format("{}{:.12e} {:.12e} {:.12e} {:.12e}", r == 0 ? "" : " ", T.R(r, 0),
                            T.R(r, 1), T.R(r, 2), T.t[r]);
    }
  }
  const CameraPoses read = read_camera_poses(folder.write("poses.txt", joined));
  ASSERT_EQ(read.poses.size(), 4u);
  const std::vector<std::filesystem::path> images{"0.png", "1.png", "2.png", "3.png"};
  const std::vector<Pose> found = poses_of_images(read, images, "poses.txt");
  for (std::size_t i = 0; i < 4; ++i) expect_same(found[i], some_poses()[i], 1e-9);
  const std::string said = error_message([&] { poses_of_images(read, {"0.png"}, "poses.txt"); });
  EXPECT_NE(said.find("has 4 poses for 1 images"), std::string::npos) << said;
}

// KITTI's files have no times; that of a line is its number, which is none.
TEST(CameraPoses, LinesWithoutTimesGoByOrder) {
  const Folder folder;
  std::string text;
  for (const Pose& T : some_poses()) {
    for (int r = 0; r < 3; ++r) {
      text += fmt::format("{:.12e} {:.12e} {:.12e} {:.12e}{}", T.R(r, 0), T.R(r, 1), T.R(r, 2),
                          T.t[r], r == 2 ? "\n" : " ");
    }
  }
  const CameraPoses read = read_camera_poses(folder.write("00.txt", text));
  const std::vector<std::filesystem::path> images{"000000.png", "000002.png", "000004.png",
                                                  "1403715273050000000.png"};
  const std::vector<Pose> found = poses_of_images(read, images, "00.txt");
  for (std::size_t i = 0; i < 4; ++i) expect_same(found[i], some_poses()[i], 1e-9);
  EXPECT_NE(error_message([&] {
              poses_of_images(read, {"000000.png"}, "00.txt");
            }).find("has 4 poses for 1 images"),
            std::string::npos);
}

// Seconds that happen to be whole are times where images are named after such seconds.
TEST(CameraPoses, WholeSecondsAreTimes) {
  const Folder folder;
  std::string text;
  for (int i = 0; i < 4; ++i) text += fmt::format("{} {} 0 0 0 0 0 1\n", i, 2 * i);
  const CameraPoses read = read_camera_poses(folder.write("tum.txt", text));
  const auto found = poses_of_images(read, {"0.5.png", "1.5.png", "2.25.png"}, "tum.txt", 2);
  EXPECT_NEAR(found[0].t.x(), 1, 1e-12);
  EXPECT_NEAR(found[2].t.x(), 4.5, 1e-12);
  EXPECT_NE(error_message([&] {
              poses_of_images(read, {"0.5.png", "1.5.png", "2.5.png", "3.5.png"}, "tum.txt", 2);
            }).find("has no pose at the time of 3.5.png"),
            std::string::npos);
}

TEST(CameraPoses, SaysWhatIsWrong) {
  const Folder folder;
  const auto said = [&](const std::string& name, const std::string& text) {
    const auto file = folder.write(name, text);
    return error_message([&] { read_camera_poses(file); });
  };
  const auto expect = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expect(said("a.csv", asl_text() + "1,2\n"), ":6: has 2 fields");
  expect(said("a.csv", asl_text() + "1,0,0,0,1,0,0,0\n"), "its time is not after");
  expect(said("a.csv", "#timestamp, x\n1,0,0,0,9,0,0,0\n"), "not of length 1");
  expect(said("a.csv", "#timestamp, x\n"), "holds no poses");
  expect(said("t.csv", table() + "00000" + matrix_row("", some_poses()[0])), "a second time");
  expect(said("t.csv", table() + "x,1\n"), "has 2 fields, not 17");
  Pose mirrored = some_poses()[0];
  mirrored.R.col(0) *= -1;
  expect(said("t.csv", table() + matrix_row("x", mirrored)), "is not a pose");
  expect(said("images.txt", "1 1 0 0 0 0 0 0 1\n"), "has 9 words, not 10");
  const Folder binary;
  binary.write("images.bin", "x");
  expect(error_message([&] { read_camera_poses(binary.path()); }), "in binary form");
  expect(error_message([&] { read_camera_poses(binary.path() / "images.bin"); }), "binary form");
}

TEST(CameraPoses, WalkIsRead) {
  const auto data = test::data_folder();
  if (!data || !std::filesystem::is_directory(*data / "sequences")) {
    GTEST_SKIP() << "VERNIER_DATA has no sequences";
  }
  const CameraPoses walk = read_camera_poses(*data / "sequences/office_walk/poses.csv");
  EXPECT_EQ(walk.poses.size(), 125u);
  EXPECT_EQ(read_camera_poses(*data / "sequences/drive/poses.txt").poses.size(), 51u);
}

}  // namespace
}  // namespace vernier::localise::internal
