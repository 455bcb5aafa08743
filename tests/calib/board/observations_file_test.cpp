// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/observations_file.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "calib/base/atomic_file.h"
#include "calib/board/frame_numbering.h"
#include "calib/board_target.h"
#include "calib/error.h"
#include "calib/simulated_board.h"
#include "tests/support/error_message.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

class ObservationsFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("vernier_observations_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string complaint_of(const std::string& text) {
    write_atomically(folder_ / "bad.csv", text);
    return test::error_message([&] {
      read_observations(folder_ / "bad.csv", {{640, 480}, {640, 480}});
    });
  }

  std::filesystem::path folder_;
};

TEST_F(ObservationsFile, RoundTripIsExact) {
  const auto before = simulate_board(test::stereo_rig(), {}, {.seed = 1}).observations;
  write_observations(before, folder_ / "o.csv");
  const auto after = read_observations(folder_ / "o.csv", before.size_px);
  ASSERT_EQ(after.views.size(), before.views.size());
  for (std::size_t i = 0; i < before.views.size(); ++i) {
    EXPECT_EQ(after.views[i].pixels_px, before.views[i].pixels_px);
  }
  EXPECT_EQ(after.target_m, before.target_m);
}

TEST_F(ObservationsFile, CornersRoundTrip) {
  auto before = simulate_board(test::stereo_rig(), {}, {.seed = 1}).observations;
  for (auto& view : before.views) {
    view.image = (view.camera == 0 ? "left" : "right") + std::to_string(view.frame) + ".png";
  }
  // a partial board
  before.views[4].ids.erase(before.views[4].ids.begin() + 5);
  before.views[4].pixels_px.erase(before.views[4].pixels_px.begin() + 5);
  write_corners(before, {}, folder_ / "corners.vnl");
  const auto after = read_corners(folder_ / "corners.vnl", {}, {{640, 480}});
  ASSERT_EQ(after.views.size(), before.views.size());
  for (std::size_t i = 0; i < before.views.size(); ++i) {
    EXPECT_EQ(after.views[i].frame, before.views[i].frame);
    EXPECT_EQ(after.views[i].ids, before.views[i].ids);
    EXPECT_EQ(after.views[i].pixels_px, before.views[i].pixels_px);
  }
}

TEST_F(ObservationsFile, ABadLineIsNamed) {
  std::string text = "frame,camera,row,col,X,Y,Z,qx,qy\n";
  for (int i = 2; i < 37; ++i) {
    text += "0,0,0," + std::to_string(i) + "," + std::to_string(i) + ",0,0,10,10\n";
  }
  EXPECT_NE(complaint_of(text + "0,0,1,0,0,1,0,ten,10\n").find("bad.csv:37: qx, qy is \"ten\""),
            std::string::npos);
  EXPECT_NE(complaint_of(text + "0,0,1\n").find("bad.csv:37: 3 columns"), std::string::npos);
  EXPECT_NE(complaint_of("frame,row\n").find("bad.csv:1:"), std::string::npos);
}

TEST_F(ObservationsFile, FramesCamerasAndRepeatsAreChecked) {
  const std::string header = "frame,camera,row,col,X,Y,Z,qx,qy\n";
  EXPECT_NE(complaint_of(header + "-1,0,0,0,0,0,0,9,9\n").find("bad.csv:2: frame is -1, below 0"),
            std::string::npos);
  for (const std::string camera : {"-1", "1024", "2000000000"}) {
    EXPECT_NE(complaint_of(header + "0," + camera + ",0,0,0,0,0,9,9\n")
                  .find("bad.csv:2: camera is " + camera + ", not within 0 to 1023"),
              std::string::npos);
  }
  EXPECT_NE(complaint_of(header + "3,1,0,2,0,0,0,9,9\n3,0,0,2,0,0,0,9,9\n3,1,0,2,0,0,0,8,9\n")
                .find("bad.csv:4: frame 3, camera 1, corner (row 0, col 2) appears a second time"),
            std::string::npos);
}

TEST_F(ObservationsFile, PixelsOutsideTheImageAreNamedByLineRowAndColumn) {
  const std::string header = "frame,camera,row,col,X,Y,Z,qx,qy\n";
  const std::string good = "0,1,0,2,0,0,0,639.5,-0.5\n";
  EXPECT_NE(
      complaint_of(header + good + "0,1,4,7,1,0,0,640,9\n")
          .find("bad.csv:3: frame 0, camera 1, corner (row 4, col 7): its pixel (640, 9) lies "
                "outside the image of 640x480; check the image size"),
      std::string::npos);
  // what no line says alone begins with the file
  write_atomically(folder_ / "bad.csv", header + good);
  const auto parts = test::error_parts([&] {
    read_observations(folder_ / "bad.csv", {{640, 480}, {640, 480}});
  });
  EXPECT_EQ(parts[0], (folder_ / "bad.csv").string());
  EXPECT_EQ(parts[1].rfind("frame 0, camera 1: fewer than four corners", 0), 0u);
  EXPECT_NE(parts[2], "");
  EXPECT_NE(complaint_of(header + good).find("bad.csv: frame 0, camera 1: fewer than four corners"),
            std::string::npos);
  EXPECT_NE(complaint_of(header + "0,2,0,2,0,0,0,9,9\n")
                .find("bad.csv: frame 0, camera 2: the image size of this camera is unknown"),
            std::string::npos);
}

TEST_F(ObservationsFile, CornersOutsideTheImageAreNamedByLineRowAndColumn) {
  const auto error_output = [&](const std::string& text, const BoardTarget& target) {
    write_atomically(folder_ / "c.vnl", text);
    return test::error_message([&] { read_corners(folder_ / "c.vnl", target, {{640, 480}}); });
  };
  std::string text = "# filename x y level\n";
  for (int i = 0; i < 8; ++i) text += "left3.png 10 10 0\n";
  EXPECT_NE(
      error_output(text + "left3.png 10 480 0\n", Chessboard{4, 3})
          .find("c.vnl:10: left3.png, corner (row 2, col 0): its pixel (10, 480) lies outside"),
      std::string::npos);
  EXPECT_NE(error_output(text + "left3.png nan 48 0\n", Chessboard{4, 3})
                .find("c.vnl:10: left3.png, corner (row 2, col 0): its pixel is not a finite"),
            std::string::npos);
  EXPECT_EQ(error_output(text, CharucoBoard{8, 6, 0.022, 0.03}),
            "8x6 ChArUco board: its markers are not smaller than its squares; give the side of a "
            "square and the smaller one of a marker");
}

TEST_F(ObservationsFile, CamerasOfCornersKeepTheirPlaceWhereTheFirstBoardIsMissing) {
  auto before = simulate_board(test::stereo_rig(), {}, {.seed = 1}).observations;
  for (auto& view : before.views) {
    view.image = (view.camera == 0 ? "L/" : "R/") + std::to_string(view.frame) + ".png";
  }
  before.views[0].ids.clear();
  before.views[0].pixels_px.clear();
  write_corners(before, {}, folder_ / "corners.vnl");
  const auto after = read_corners(folder_ / "corners.vnl", {}, {{640, 480}});
  ASSERT_EQ(after.views.size(), before.views.size() - 1);
  for (std::size_t i = 0; i < after.views.size(); ++i) {
    EXPECT_EQ(after.views[i].camera, before.views[i + 1].camera);
    EXPECT_EQ(after.views[i].image, before.views[i + 1].image);
    EXPECT_EQ(after.views[i].pixels_px, before.views[i + 1].pixels_px);
  }
}

TEST_F(ObservationsFile, ImagesThatWouldNotReadBackAreRefused) {
  const auto error_output = [&](const std::string& left, const std::string& right) -> std::string {
    auto observations = simulate_board(test::stereo_rig(), {}, {.seed = 1}).observations;
    for (auto& view : observations.views) {
      view.image = (view.camera == 0 ? left : right) + std::to_string(view.frame) + ".png";
    }
    return test::error_message([&] { write_corners(observations, {}, folder_ / "corners.vnl"); });
  };
  EXPECT_EQ(error_output("L/", "R/"), "");
  EXPECT_NE(
      error_output("my board/left", "right").find("my board/left0.png: a corners file cannot"),
      std::string::npos);
  EXPECT_NE(error_output("left", "#right").find("#right0.png: a corners file cannot"),
            std::string::npos);
  EXPECT_NE(
      error_output("image", "image").find("image0.png: by its name it would be read as camera"),
      std::string::npos);
}

TEST(ImageName, LastNumberIsTheFrame) {
  EXPECT_EQ(parse_image_name("a/left07.png").frame, 7);
  EXPECT_EQ(parse_image_name("cam2_0031_raw.png").frame, 31);
  EXPECT_EQ(parse_image_name("x/left07.png").camera, parse_image_name("x/left12.jpg").camera);
  EXPECT_NE(parse_image_name("x/left07.png").camera, parse_image_name("x/right07.png").camera);
  EXPECT_THROW(parse_image_name("left.png"), Error);
  EXPECT_THROW(parse_image_name("set/left.png"), Error);
  EXPECT_EQ(parse_image_name("set2/012/left.png").frame, 12);
  EXPECT_EQ(parse_image_name("s/001/left.png").camera, parse_image_name("s/002/left.png").camera);
  EXPECT_NE(parse_image_name("s/001/left.png").camera, parse_image_name("s/001/right.png").camera);
  EXPECT_EQ(parse_image_name("cam0/1403636579763555584.png").frame, 1403636579763555584);
  EXPECT_THROW(parse_image_name("cam0/99999999999999999999.png"), Error);
}

TEST(ImageName, NumbersBeyondAFramesRangeNumberFramesInTheirOrder) {
  const FrameNumbering small({7, 3, 7, 2147483647});
  EXPECT_EQ(small.frame(7), 7);
  EXPECT_EQ(small.frame(2147483647), 2147483647);
  const FrameNumbering stamps({50'000'000'000, 7, 40'000'000'000, 50'000'000'000, 2147483648});
  EXPECT_EQ(stamps.frame(7), 0);
  EXPECT_EQ(stamps.frame(2147483648), 1);
  EXPECT_EQ(stamps.frame(40'000'000'000), 2);
  EXPECT_EQ(stamps.frame(50'000'000'000), 3);
}

// frame01_cam0.png: the number that changes is not the last.
TEST_F(ObservationsFile, ACameraAfterTheFrameInNamesIsTold) {
  std::string text;
  for (int frame = 1; frame < 7; ++frame) {
    for (int camera = 0; camera < 2; ++camera) {
      text += "frame0" + std::to_string(frame) + "_cam" + std::to_string(camera) + ".png - - -\n";
    }
  }
  write_atomically(folder_ / "c.vnl", text);
  EXPECT_NE(test::error_message([&] {
              read_corners(folder_ / "c.vnl", Chessboard{9, 6, 0.025}, {{640, 480}});
            }).find("6 cameras and 2 frames: the last number in a name is the frame"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
