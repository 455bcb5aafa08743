// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "calib/board/corner_refinement.h"
#include "calib/board_detection.h"
#include "calib/board_target.h"
#include "tests/support/board_images.h"

namespace vernier {

using namespace vernier::internal;

namespace {

using test::BoardCamera;

const AprilTagGrid april{6, 6, 0.088, 0.3};
constexpr double gap_m = 0.3 * 0.088;  // the side of the squares between the tags

BoardDetection detect(const cv::Mat& image, const BoardTarget& target) {
  const auto file = std::filesystem::temp_directory_path() /
                    ("vernier_marker_corners_" + std::to_string(::getpid()) + ".png");
  cv::imwrite(file.string(), image);
  BoardDetection found = detect_board(file, target);
  std::filesystem::remove(file);
  return found;
}

/// An equidistant lens of 180° across close to the grid, the board tilted and turned.
BoardCamera fisheye_before(double distance, double tilt_x, double tilt_y, double turn) {
  const auto points = target_points(april);
  const Eigen::Vector2d middle = 0.5 * (points.front() + points.back()).head<2>();
  BoardCamera camera =
      test::camera_before(middle, distance, tilt_x + std::numbers::pi, tilt_y, turn);
  camera.fisheye = true;
  camera.f_px = 300;
  camera.width_px = 960;
  camera.height_px = 720;
  return camera;
}

double error_px(const BoardDetection& found, const BoardCamera& camera) {
  const auto points = target_points(april);
  double worst = 0;
  for (std::size_t i = 0; i < found.ids.size(); ++i) {
    worst = std::max(worst, (found.corners_px[i] - camera.pixel_of(points[found.ids[i]])).norm());
  }
  return worst;
}

TEST(MarkerCorners, AWideLensMovesNoCornerToTheNextCrossing) {
  std::size_t corners = 0;
  for (const auto& [x, y, turn] : std::vector<std::array<double, 3>>{
           {0.2, 0.9, 0.1}, {-0.9, 0.3, 1.3}, {0.7, -0.7, 3.0}, {0.0, 1.1, 0.2}}) {
    const BoardCamera camera = fisheye_before(0.36, x, y, turn);
    const BoardDetection found = detect(test::photograph(test::draw(april, 2), camera), april);
    ASSERT_FALSE(found.ids.empty()) << found.reason;
    EXPECT_LT(error_px(found, camera), 1.5) << x << " " << y << " " << turn;
    corners += found.ids.size();
  }
  EXPECT_GE(corners, 350u);
}

TEST(MarkerCorners, ACornerRefinedBeyondItsReachIsAnother) {
  const BoardCamera camera = fisheye_before(0.5, 0.1, 0.1, 0);
  const cv::Mat image = test::photograph(test::draw(april, 2), camera);
  const auto points = target_points(april);
  constexpr int id = 65;  // in the middle
  const auto at = [&](double gaps) -> Eigen::Vector2d {
    return camera.pixel_of(points[id] + Eigen::Vector3d(gaps * gap_m, 0, 0));
  };
  Eigen::Matrix2d px_per_m;
  px_per_m << (at(1) - at(0)) / gap_m,
      (camera.pixel_of(points[id] + Eigen::Vector3d(0, gap_m, 0)) - at(0)) / gap_m;
  for (const double reach : {0.5, 0.2}) {
    BoardDetection found;
    refine_corners(image, {{id, at(0.35), 9, reach * gap_m, px_per_m}}, points,
                   CornerKind::crossing, found);
    if (reach > 0.35) {
      ASSERT_EQ(found.ids.size(), 1u) << rejected_corners_text(found);
      EXPECT_LT((found.corners_px[0] - at(0)).norm(), 0.3);
    } else {
      ASSERT_EQ(found.rejected_corners.size(), 1u);
      EXPECT_EQ(found.rejected_corners[0].why, CornerRejection::moved_too_far);
    }
  }
}

// Many quadrilaterals beside the board, which make the first of OpenCV's finders slow: it is left
// out only where there is no board.
TEST(ChessboardFinder, FindsABoardBesideAGridOfTags) {
  const Chessboard board{9, 6, 0.03};
  const auto points = target_points(board);
  const BoardCamera before_board =
      test::camera_before(0.5 * (points.front() + points.back()).head<2>(), 0.4, 0.2, 0.2, 0.1);
  const cv::Mat chess = test::photograph(test::draw(board), before_board);
  const auto corners = target_points(april);
  const cv::Mat tags = test::photograph(
      test::draw(april, 2), test::camera_before(0.5 * (corners.front() + corners.back()).head<2>(),
                                                1.2, std::numbers::pi, 0, 0));
  EXPECT_NE(detect(tags, board).reason.find("no 9x6 board found"), std::string::npos);
  cv::Mat both;
  cv::hconcat(chess, tags, both);
  const BoardDetection alone = detect(chess, board), beside = detect(both, board);
  ASSERT_FALSE(alone.ids.empty()) << alone.reason;
  ASSERT_EQ(beside.ids, alone.ids) << beside.reason;
  for (std::size_t i = 0; i < alone.ids.size(); ++i) {
    EXPECT_LT((beside.corners_px[i] - alone.corners_px[i]).norm(), 0.05);
  }
}

}  // namespace
}  // namespace vernier
