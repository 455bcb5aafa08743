// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board_target.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "calib/base/atomic_file.h"
#include "calib/board/kalibr_target.h"
#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::internal;

namespace {

std::string complaint_of(const BoardTarget& target) {
  return test::error_message([&] { check_target(target); });
}

TEST(BoardTarget, PointsFollowTheDocumentedOrder) {
  const auto chess = target_points(Chessboard{4, 3, 0.02, 0.03});
  EXPECT_EQ(chess.size(), 12u);
  EXPECT_TRUE(chess[5].isApprox(Eigen::Vector3d(0.02, 0.03, 0)));
  const auto charuco = target_points(CharucoBoard{5, 4, 0.03, 0.02});
  EXPECT_EQ(charuco.size(), 12u);
  EXPECT_TRUE(charuco[0].isZero(0));
  EXPECT_TRUE(charuco[5].isApprox(Eigen::Vector3d(0.03, 0.03, 0)));
  // Kalibr's figure: tag 3 of a 2 x 2 grid has points 10, 11 below and 14, 15 above.
  const auto tags = target_points(AprilTagGrid{2, 2, 0.1, 0.3});
  EXPECT_EQ(tags.size(), 16u);
  EXPECT_TRUE(tags[1].isApprox(Eigen::Vector3d(0.1, 0, 0)));
  EXPECT_TRUE(tags[10].isApprox(Eigen::Vector3d(0.13, 0.13, 0)));
  EXPECT_TRUE(tags[15].isApprox(Eigen::Vector3d(0.23, 0.23, 0)));
}

TEST(BoardTarget, ImpossibleOnesAreNamed) {
  EXPECT_EQ(complaint_of(Chessboard{}), "");
  EXPECT_EQ(complaint_of(Chessboard{2, 6}),
            "2x6 board: fewer than 3 inner corners along a side; count the inner corners, not the "
            "squares");
  EXPECT_NE(complaint_of(Chessboard{6, 6, 0.03, 0.02}).find("as many columns as rows"),
            std::string::npos);
  EXPECT_NE(complaint_of(CharucoBoard{8, 6, 0.02, 0.03}).find("not smaller than its squares"),
            std::string::npos);
  EXPECT_NE(complaint_of(CharucoBoard{8, 6, 0.03, 0.02, "4x5_50"}).find("supported: 4x4_50, "),
            std::string::npos);
  EXPECT_NE(complaint_of(CharucoBoard{12, 12}).find("it has 72 markers, 4x4_50 has 50"),
            std::string::npos);
  EXPECT_NE(complaint_of(AprilTagGrid{30, 20}).find("it has 600 markers"), std::string::npos);
  EXPECT_EQ(complaint_of(Chessboard{100000, 100000}),
            "100000x100000 board: more than 1000 along a side; check its size");
  for (const BoardTarget& target :
       {BoardTarget(CharucoBoard{8, 1001}), BoardTarget(AprilTagGrid{1 << 20, 1 << 20})}) {
    EXPECT_NE(complaint_of(target).find("more than 1000 along a side"), std::string::npos);
  }
  EXPECT_NE(complaint_of(AprilTagGrid{6, 6, 0.08, 0}).find("spacing"), std::string::npos);
}

class KalibrTarget : public testing::Test {
 protected:
  void SetUp() override {
    file_ = std::filesystem::temp_directory_path() /
            ("vernier_target_" + std::to_string(::getpid()) + ".yaml");
  }
  void TearDown() override { std::filesystem::remove(file_); }

  BoardTarget read(const std::string& text) {
    write_atomically(file_, text);
    return read_kalibr_target(file_);
  }
  std::string error_output(const std::string& text) {
    const std::string what = test::error_message([&] { read(text); });
    return what.rfind(file_.string(), 0) == 0 ? what.substr(file_.string().size()) : what;
  }

  std::filesystem::path file_;
};

TEST_F(KalibrTarget, ItsTwoExamplesAreRead) {
  const auto tags = std::get<AprilTagGrid>(
      read("target_type: 'aprilgrid' #gridtype\ntagCols: 6               #number of apriltags\n"
           "tagRows: 5\n\ntagSize: 0.088           #size of apriltag, edge to edge [m]\r\n"
           "tagSpacing: 0.3          #ratio of space between tags to tagSize\n"));
  EXPECT_EQ(tags.columns, 6);
  EXPECT_EQ(tags.rows, 5);
  EXPECT_EQ(tags.tag_m, 0.088);
  EXPECT_EQ(tags.spacing, 0.3);
  EXPECT_EQ(tags.border_bits, 0);
  const auto board = std::get<Chessboard>(
      read("# comment\ntarget_type: \"checkerboard\"\ntargetCols: 6\ntargetRows: 7\n"
           "rowSpacingMeters: 0.06\ncolSpacingMeters: 0.05"));
  EXPECT_EQ(board.columns, 6);
  EXPECT_EQ(board.rows, 7);
  EXPECT_EQ(board.square_m, 0.05);
  EXPECT_EQ(board.row_m, 0.06);
}

TEST_F(KalibrTarget, TagsMayBeSaidToCountFromZero) {
  const std::string text =
      "target_type: 'aprilgrid'\ntagCols: 6\ntagRows: 6\ntagSize: 0.088\ntagSpacing: 0.3\n";
  EXPECT_EQ(std::get<AprilTagGrid>(read(text + "codeOffset: 0\n")).columns, 6);
  EXPECT_EQ(error_output(text + "codeOffset: 12\n"),
            ":6: codeOffset is \"12\"; only codeOffset 0 is supported");
}

TEST_F(KalibrTarget, FaultsAreNamedWithTheirLine) {
  EXPECT_EQ(error_output("\ntarget_type: circlegrid\n"),
            ":2: circlegrid targets are not supported; use a checkerboard, a ChArUco board or "
            "an aprilgrid");
  EXPECT_EQ(error_output("target_type: hexgrid\n"),
            ":1: target_type is \"hexgrid\"; supported: aprilgrid, checkerboard");
  EXPECT_EQ(error_output("tagCols: 6\n").substr(0, 31), ": the key target_type is missin");
  EXPECT_EQ(error_output("target_type: aprilgrid\ntagCols: six\n"),
            ":2: tagCols is \"six\"; give a whole number of 1 to 1000");
  EXPECT_EQ(error_output("target_type: aprilgrid\ntagCols: 6\ntagRows: 6\ntagSize: -0.1\n"),
            ":4: tagSize is \"-0.1\"; give a number above 0");
  EXPECT_EQ(error_output("target_type: aprilgrid\ntagCols: 6\ntagCols: 6\n").substr(0, 3), ":3:");
  EXPECT_NE(error_output("target_type: aprilgrid\ntagCols: 6\ntagRows: 6\ntagSize: 0.1\n"
                         "tagSpacing: 0.3\nlowId: 4\n")
                .find(":6: unknown key 'lowId'"),
            std::string::npos);
  EXPECT_NE(error_output("just text\n").find(":1: is not of the form key: value"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
