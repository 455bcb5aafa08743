// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "calib/board_detection.h"
#include "calib/board_target.h"
#include "calib/statistics/random.h"
#include "tests/support/board_images.h"

namespace vernier {
namespace {

using test::BoardCamera;

const Chessboard chessboard{9, 6, 0.03};
const Eigen::Vector2d middle{0.12, 0.075};

BoardDetection detect(const cv::Mat& image, const Chessboard& board) {
  const auto file = std::filesystem::temp_directory_path() /
                    ("vernier_noisy_boards_" + std::to_string(::getpid()) + ".png");
  cv::imwrite(file.string(), image);
  BoardDetection found = detect_board(file, board);
  std::filesystem::remove(file);
  return found;
}

BoardCamera camera_at(double distance) {
  BoardCamera camera = test::camera_before(middle, distance, 0.3, 0.35, 0.1);
  camera.width_px = 960;
  camera.height_px = 720;
  return camera;
}

/// Grey ground with the noise of a sensor, which a threshold near its mean makes into specks.
cv::Mat on_noisy_ground(double distance) {
  return test::photograph(
      [&, drawn = test::draw(chessboard)](const Eigen::Vector2d& p) {
        const Eigen::Vector2d off = (p - middle).cwiseAbs();
        return off.x() < 0.2 && off.y() < 0.155 ? drawn(p) : 140;
      },
      camera_at(distance));
}

double rms_px(const BoardDetection& found, const BoardCamera& camera) {
  const auto points = target_points(chessboard);
  double squares = 0;
  for (std::size_t i = 0; i < found.ids.size(); ++i) {
    squares += (found.corners_px[i] - camera.pixel_of(points[found.ids[i]])).squaredNorm();
  }
  return std::sqrt(squares / (2.0 * static_cast<double>(found.ids.size())));
}

// The search of thousands of specks takes up to a minute, that of a smoothed copy a second.
TEST(NoisyBoards, ABoardThatIsNotThereIsLookedForInASmoothedCopyAndThatIsSaid) {
  const std::string reason = detect(on_noisy_ground(0.5), Chessboard{11, 8, 0.03}).reason;
  EXPECT_NE(reason.find("only 9x6 of its corners were found"), std::string::npos) << reason;
  EXPECT_NE(reason.find("one of two searches was in a copy smoothed by "), std::string::npos)
      << reason;
}

TEST(NoisyBoards, ABoardThatIsThereIsFoundAsExactly) {
  for (const double distance : {0.5, 1.6}) {
    const BoardDetection found = detect(on_noisy_ground(distance), chessboard);
    ASSERT_EQ(found.ids.size(), 54u) << found.reason;
    EXPECT_LT(rms_px(found, camera_at(distance)), 0.08) << distance;
  }
}

// Squares of 9 px, and 150 dots of 8 px: dots are no reason to search less.
TEST(NoisyBoards, ASmallBoardAmongRoundDotsIsFound) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    BoardCamera camera = test::camera_before(middle, 1.75, 0, 0, 0.15);
    camera.width_px = 480;
    camera.height_px = 360;
    cv::Mat image = test::photograph(test::draw(chessboard), camera);
    vernier::internal::RandomStream d({.seed = seed});
    for (int dots = 0; dots < 150;) {
      const Eigen::Vector2d off{d.uniform(-235, 235), d.uniform(-175, 175)};
      if (std::abs(off.x()) < 65 && std::abs(off.y()) < 55) continue;
      const Eigen::Vector2d p = camera.centre() + off;
      cv::circle(image, {cvRound(p.x()), cvRound(p.y())}, 4, test::ink, cv::FILLED, cv::LINE_AA);
      ++dots;
    }
    const BoardDetection found = detect(image, chessboard);
    ASSERT_EQ(found.ids.size(), 54u) << seed << ": " << found.reason;
    EXPECT_LT(rms_px(found, camera), 0.2) << seed;
  }
}

}  // namespace
}  // namespace vernier
