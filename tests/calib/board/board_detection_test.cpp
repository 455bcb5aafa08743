// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board_detection.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "calib/base/atomic_file.h"
#include "calib/board_observations.h"
#include "calib/board_target.h"
#include "calib/error.h"
#include "calib/observations_file.h"
#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::internal;

namespace {

constexpr Chessboard board{9, 6, 0.025};

/// A grey image of 440 x 320 pixels, with a board of 30 pixels a square or with none.
std::string image_text(bool with_board, int left_px) {
  std::string text = "P5\n440 320\n255\n";
  for (int y = 0; y < 320; ++y) {
    for (int x = 0; x < 440; ++x) {
      const int column = (x - left_px) / 30, row = (y - 50) / 30;
      const bool on_board = x >= left_px && column < 10 && y >= 50 && row < 7;
      text += with_board && on_board && (row + column) % 2 == 0 ? '\x14' : '\xe6';
    }
  }
  return text;
}

class BoardDetectionTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("vernier_board_detection_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_ / "L");
    std::filesystem::create_directories(folder_ / "R");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write_image(const std::string& name, bool with_board = true) {
    write_atomically(folder_ / name, image_text(with_board, name[0] == 'L' ? 70 : 50));
  }
  std::string pattern(const std::string& name) const { return (folder_ / name).string(); }

  std::filesystem::path folder_;
};

TEST_F(BoardDetectionTest, CornersFileKeepsLeftAndRightWhereTheFirstLeftBoardIsMissing) {
  write_image("L/01.pgm", false);
  write_image("L/02.pgm");
  write_image("R/01.pgm");
  write_image("R/02.pgm");
  const ImageDetections found = detect_images({pattern("L/*.pgm"), pattern("R/*.pgm")}, board);
  ASSERT_EQ(found.refused.size(), 1u);
  EXPECT_EQ(found.refused[0].reason, "no 9x6 board found; low contrast: grey values of 230 to 230");
  write_corners(found, board, folder_ / "corners.vnl");
  EXPECT_NE(read_whole(folder_ / "corners.vnl").find(pattern("L/01.pgm") + " - - -\n"),
            std::string::npos);

  const BoardObservations after = read_corners(folder_ / "corners.vnl", board, {{440, 320}});
  const auto& before = found.observations.views;
  ASSERT_EQ(after.views.size(), 3u);
  ASSERT_EQ(before.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(after.views[i].camera, before[i].camera);
    EXPECT_EQ(after.views[i].frame, before[i].frame);
    EXPECT_EQ(after.views[i].image, before[i].image);
    EXPECT_EQ(after.views[i].pixels_px, before[i].pixels_px);
  }
  EXPECT_EQ(after.views[0].camera, 1);
  EXPECT_EQ(after.views[0].frame, 1);
}

TEST_F(BoardDetectionTest, AnImageThatCannotBeReadIsRefusedByName) {
  write_image("L/01.pgm");
  write_image("L/02.pgm");
  write_image("L/03.pgm");
  write_image("R/01.pgm");
  write_image("R/02.pgm");
  write_image("R/03.pgm");
  std::filesystem::resize_file(folder_ / "L/01.pgm", 9000);
  write_atomically(folder_ / "R/02.pgm", "no image");
  const ImageDetections found = detect_images({pattern("L/*.pgm"), pattern("R/*.pgm")}, board);
  EXPECT_EQ(found.used.size(), 4u);
  EXPECT_EQ(found.observations.views.size(), 4u);
  EXPECT_EQ(found.observations.size_px[0], Eigen::Vector2i(440, 320));
  ASSERT_EQ(found.refused.size(), 2u);
  EXPECT_EQ(found.refused[0].image, folder_ / "L/01.pgm");
  EXPECT_EQ(found.refused[0].frame, 1);
  EXPECT_EQ(found.refused[0].reason,
            "is cut off (it has fewer pixels than its header says); copy it again, or leave it "
            "out");
  EXPECT_EQ(found.refused[1].image, folder_ / "R/02.pgm");
  EXPECT_EQ(found.refused[1].camera, 1);
  EXPECT_EQ(found.refused[1].reason, "is not an image that can be read; check the file");
  write_corners(found, board, folder_ / "corners.vnl");
  EXPECT_NE(read_whole(folder_ / "corners.vnl").find(pattern("R/02.pgm") + " - - -\n"),
            std::string::npos);
}

TEST_F(BoardDetectionTest, ACameraWhoseImagesCannotBeReadIsAnErrorThatNamesTheFirst) {
  write_image("L/01.pgm");
  write_image("L/02.pgm");
  write_image("R/01.pgm");
  write_image("R/02.pgm");
  write_atomically(folder_ / "R/01.pgm", "no image");
  std::filesystem::resize_file(folder_ / "R/02.pgm", 9000);
  EXPECT_EQ(test::error_message([&] {
              detect_images({pattern("L/*.pgm"), pattern("R/*.pgm")}, board);
            }),
            pattern("R/01.pgm") + ": is not an image that can be read; check the file");
}

TEST_F(BoardDetectionTest, FramesThatDoNotPairAreAnError) {
  write_image("L/01.pgm");
  write_image("R/11.pgm");
  try {
    detect_images({pattern("L/*.pgm"), pattern("R/*.pgm")}, board);
    FAIL() << "no Error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("shares no frame number with the cameras before it"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace vernier
