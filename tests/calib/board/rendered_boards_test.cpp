// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <numbers>
#include <opencv2/imgcodecs.hpp>

#include "calib/base/atomic_file.h"
#include "calib/board_detection.h"
#include "calib/board_observations.h"
#include "calib/board_target.h"
#include "calib/calibrate.h"
#include "calib/error.h"
#include "calib/observations_file.h"
#include "calib/rig_estimate.h"
#include "tests/support/board_images.h"

namespace vernier {

using namespace vernier::internal;

namespace {

using test::BoardCamera;
using test::camera_before;
using test::draw;
using test::photograph;

const Chessboard rendered_chessboard{9, 6, 0.03};
const CharucoBoard charuco{8, 6, 0.04, 0.029, "5x5_100"};
const AprilTagGrid april_grid{6, 5, 0.05, 0.3};

Eigen::Vector2d middle_of(const BoardTarget& target) {
  const auto points = target_points(target);
  return 0.5 * (points.front() + points.back()).head<2>();
}

class RenderedBoards : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("vernier_rendered_boards_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path save(const cv::Mat& image, const std::string& name = "left01.png") {
    cv::imwrite((folder_ / name).string(), image);
    return folder_ / name;
  }
  BoardDetection detect(const cv::Mat& image, const BoardTarget& target) {
    return detect_board(save(image), target);
  }

  std::filesystem::path folder_;
};

/// Root mean square error a coordinate, pixels.
double rms_error(const BoardDetection& found,
                 const BoardTarget& target,
                 const BoardCamera& camera) {
  const auto points = target_points(target);
  double sum = 0;
  for (std::size_t i = 0; i < found.ids.size(); ++i) {
    sum += (found.corners_px[i] - camera.pixel_of(points[found.ids[i]])).squaredNorm();
  }
  return std::sqrt(sum / (2.0 * static_cast<double>(found.ids.size())));
}

/// The same, told to whoever asks for the tests' XML.
double told_rms(const BoardDetection& found,
                const BoardTarget& target,
                const BoardCamera& camera,
                const std::string& name) {
  const double rms = rms_error(found, target, camera);
  testing::Test::RecordProperty(name, std::to_string(rms) + " px, " +
                                          std::to_string(found.ids.size()) + " corners, " +
                                          rejected_corners_text(found));
  return rms;
}

double worst_error(const BoardDetection& found,
                   const BoardTarget& target,
                   const BoardCamera& camera) {
  const auto points = target_points(target);
  double worst = 0;
  for (std::size_t i = 0; i < found.ids.size(); ++i) {
    worst = std::max(worst, (found.corners_px[i] - camera.pixel_of(points[found.ids[i]])).norm());
  }
  return worst;
}

/// Turned a little; y of an AprilTag grid points up, so it is seen from its front after half a turn
/// about x.
BoardCamera usual_camera(const BoardTarget& target, double distance, double turn = 0.1) {
  const bool y_up = std::holds_alternative<AprilTagGrid>(target);
  return camera_before(middle_of(target), distance, 0.3 + (y_up ? std::numbers::pi : 0), 0.35,
                       turn);
}

// Bounds: at most 1.5 times the worst that was measured, which stands behind them, at 0.7 px of
// blur and noise of 2 grey values in 195.

TEST_F(RenderedBoards, ChessboardIsFoundWithinItsBound) {
  const BoardCamera camera = usual_camera(rendered_chessboard, 0.4);
  const BoardDetection found =
      detect(photograph(draw(rendered_chessboard), camera), rendered_chessboard);
  ASSERT_EQ(found.ids.size(), 54u) << found.reason;
  EXPECT_LT(told_rms(found, rendered_chessboard, camera, "rms_1"), 0.047);  // 0.0316
}

TEST_F(RenderedBoards, SquaresNeedNotBeSquare) {
  const Chessboard board{9, 6, 0.03, 0.022};
  const BoardCamera camera = usual_camera(board, 0.4);
  const BoardDetection found = detect(photograph(draw(board), camera), board);
  ASSERT_EQ(found.ids.size(), 54u) << found.reason;
  EXPECT_LT(told_rms(found, board, camera, "rms_2"), 0.055);  // 0.0372
}

TEST_F(RenderedBoards, CharucoIsFoundWithinItsBoundAtAnyTurn) {
  for (const double turn : {0.1, 1.7, 3.1, 4.9}) {
    const BoardCamera camera = usual_camera(charuco, 0.5, turn);
    const BoardDetection found =
        detect(photograph(draw(charuco, cv::aruco::DICT_5X5_100), camera), charuco);
    ASSERT_EQ(found.ids.size(), 35u) << found.reason;
    EXPECT_LT(told_rms(found, charuco, camera, "rms_3"), 0.06) << turn;  // 0.0585
  }
}

TEST_F(RenderedBoards, KalibrsCodesAreThoseOfTheDrawings) {
  EXPECT_EQ(test::code_36h11(0), 0xd5d628584u);
  EXPECT_EQ(test::code_36h11(1), 0xd97f18b49u);
  EXPECT_EQ(test::code_36h11(6), 0x056a5d085u);
}

TEST_F(RenderedBoards, KalibrsGridIsFoundWithinItsBoundAtAnyTurn) {
  for (const int border_bits : {2, 1}) {
    for (const double turn : {0.1, 1.7, 3.1, 4.9}) {
      const BoardCamera camera = usual_camera(april_grid, 0.5, turn);
      const BoardDetection found =
          detect(photograph(draw(april_grid, border_bits), camera), april_grid);
      EXPECT_GE(found.ids.size(), 116u) << found.reason << " border " << border_bits;
      ASSERT_FALSE(found.ids.empty());
      EXPECT_LT(told_rms(found, april_grid, camera, "rms_4_" + std::to_string(border_bits)),
                0.08)  // 0.053
          << border_bits << " " << turn;
      EXPECT_LT(worst_error(found, april_grid, camera), 0.5);  // 0.331
    }
  }
}

TEST_F(RenderedBoards, TagsWithoutSquaresBetweenAreBiasedByBlurButFound) {
  const BoardCamera camera = usual_camera(april_grid, 0.5);
  const BoardDetection found = detect(photograph(draw(april_grid, 2, false), camera), april_grid);
  EXPECT_EQ(found.ids.size(), 120u) << found.reason;
  EXPECT_LT(told_rms(found, april_grid, camera, "rms_5"), 0.18);  // 0.119
}

TEST_F(RenderedBoards, WideLensDoesNotConfuseMarkers) {
  BoardCamera camera = usual_camera(april_grid, 0.3);
  camera.f_px = 330;
  camera.k1 = -0.22;
  const BoardDetection tags = detect(photograph(draw(april_grid, 2), camera), april_grid);
  EXPECT_GE(tags.ids.size(), 100u) << tags.reason;
  EXPECT_LT(told_rms(tags, april_grid, camera, "rms_6"), 0.053);  // 0.0355
  camera = usual_camera(charuco, 0.3);
  camera.f_px = 330;
  camera.k1 = -0.22;
  const BoardDetection corners =
      detect(photograph(draw(charuco, cv::aruco::DICT_5X5_100), camera), charuco);
  EXPECT_GE(corners.ids.size(), 33u) << corners.reason;
  EXPECT_LT(told_rms(corners, charuco, camera, "rms_7"), 0.07);  // 0.047
}

/// Covers a part of the image as a hand would: mid grey, with an edge.
void cover(cv::Mat& image) {
  cv::ellipse(image, {250, 230}, {110, 70}, 25, 0, 360, 120, cv::FILLED, cv::LINE_AA);
  cv::ellipse(image, {250, 230}, {60, 30}, 25, 0, 360, 150, cv::FILLED, cv::LINE_AA);
}

TEST_F(RenderedBoards, CoveredCornersAreNotUsed) {
  for (const BoardTarget& target : {BoardTarget(charuco), BoardTarget(april_grid)}) {
    const BoardCamera camera = usual_camera(target, 0.5);
    cv::Mat image = std::holds_alternative<CharucoBoard>(target)
                        ? photograph(draw(charuco, cv::aruco::DICT_5X5_100), camera)
                        : photograph(draw(april_grid, 2), camera);
    cover(image);
    const BoardDetection found = detect(image, target);
    const std::size_t all = target_points(target).size();
    EXPECT_GT(found.ids.size(), all / 3) << found.reason;
    EXPECT_LT(found.ids.size(), all);
    EXPECT_LT(told_rms(found, target, camera, "rms_8"), 0.06) << name_of(target);  // 0.0401
    EXPECT_LT(worst_error(found, target, camera), 0.32) << name_of(target);        // 0.214
  }
}

TEST_F(RenderedBoards, HalfOfABoardOutsideTheImageIsUsedAsItIs) {
  for (const BoardTarget& target : {BoardTarget(charuco), BoardTarget(april_grid)}) {
    BoardCamera camera = usual_camera(target, 0.5);
    camera.t.x() += 0.28;
    const bool tags = std::holds_alternative<AprilTagGrid>(target);
    const BoardDetection found = detect(
        photograph(tags ? draw(april_grid, 2) : draw(charuco, cv::aruco::DICT_5X5_100), camera),
        target);
    const std::size_t all = target_points(target).size();
    EXPECT_GE(found.ids.size(), 8u) << found.reason;
    EXPECT_LT(found.ids.size(), 3 * all / 4);
    EXPECT_LT(told_rms(found, target, camera, "rms_9"), 0.063) << name_of(target);  // 0.0426
    EXPECT_TRUE(std::is_sorted(found.ids.begin(), found.ids.end()));
  }
}

TEST_F(RenderedBoards, WrongBoardsAreRefusedWithARemedy) {
  const auto reason = [&](const cv::Mat& image, const BoardTarget& target) {
    const BoardDetection found = detect(image, target);
    EXPECT_TRUE(found.ids.empty());
    return found.reason;
  };
  const cv::Mat chess =
      photograph(draw(rendered_chessboard), usual_camera(rendered_chessboard, 0.4));
  for (const Chessboard& part : {Chessboard{8, 6}, Chessboard{9, 5}, Chessboard{7, 5}}) {
    EXPECT_NE(reason(chess, part).find("the board seems to have more inner corners than"),
              std::string::npos)
        << part.columns << "x" << part.rows << ": " << reason(chess, part);
  }
  EXPECT_NE(
      reason(chess, Chessboard{11, 8})
          .find(
              "only 9x6 of its corners were found, the others are occluded or the board has fewer"),
      std::string::npos)
      << reason(chess, Chessboard{11, 8});
  const cv::Mat marked =
      photograph(draw(charuco, cv::aruco::DICT_5X5_100), usual_camera(charuco, 0.5));
  EXPECT_NE(reason(marked, CharucoBoard{6, 8, 0.04, 0.029, "5x5_100"}).find("swap"),
            std::string::npos);
  EXPECT_NE(
      reason(marked, CharucoBoard{8, 6, 0.04, 0.029, "5x5_100", true}).find("leave out --legacy"),
      std::string::npos);
  EXPECT_NE(
      reason(marked, CharucoBoard{8, 6, 0.04, 0.029, "7x7_50"}).find("none with a pattern of"),
      std::string::npos)
      << reason(marked, CharucoBoard{8, 6, 0.04, 0.029, "7x7_50"});
  AprilTagGrid from_top = april_grid;
  from_top.top_row_first = true;
  const cv::Mat tags = photograph(draw(from_top, 2), usual_camera(april_grid, 0.5));
  EXPECT_NE(reason(tags, april_grid).find("give --top-row-first"), std::string::npos)
      << reason(tags, april_grid);
  EXPECT_EQ(detect(tags, from_top).ids.size(), 120u);
}

TEST_F(RenderedBoards, BoardOfMoreCornersThanSaidIsNoResult) {
  const cv::Mat chess =
      photograph(draw(rendered_chessboard), usual_camera(rendered_chessboard, 0.4));
  save(chess, "left01.png");
  save(chess, "left02.png");
  try {
    detect_images({(folder_ / "left*.png").string()}, Chessboard{8, 6});
    FAIL() << "no Error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what())
                  .find("in 2 of 2 images the board seems to have more inner corners than the 8x6 "
                        "board; count them again"),
              std::string::npos)
        << error.what();
  }
}

TEST_F(RenderedBoards, TagsBeyondTheGridAreNamed) {
  const cv::Mat tags = photograph(draw(april_grid, 2), usual_camera(april_grid, 0.5));
  const std::string files = save(tags).string();
  const auto complaint = [&](int columns, int rows) -> std::string {
    try {
      detect_images({files}, AprilTagGrid{columns, rows, april_grid.tag_m, april_grid.spacing});
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(complaint(6, 5), "");
  EXPECT_NE(complaint(6, 4).find("in 1 of 1 images the board goes on with tags that the"),
            std::string::npos);
  EXPECT_NE(complaint(6, 4).find("has not: 24, 25, 26, 27, 28"), std::string::npos)
      << complaint(6, 4);
  EXPECT_NE(complaint(5, 5).find("a board of 6 columns: count them again"), std::string::npos)
      << complaint(5, 5);
  EXPECT_NE(complaint(7, 5).find("a board of 6 columns: count them again"), std::string::npos)
      << complaint(7, 5);
  EXPECT_EQ(complaint(6, 6), "");  // a row hidden, or none: no tag tells

  // A tag that lies elsewhere in the scene is no part of the board.
  cv::Mat stray = cv::Mat(tags.rows + 120, tags.cols, CV_8U, 255.0), tag;
  tags.copyTo(stray.rowRange(0, tags.rows));
  cv::aruco::drawMarker(cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11), 27, 80,
                        tag, 2);
  tag.copyTo(stray(cv::Rect(30, tags.rows + 20, 80, 80)));
  const BoardDetection seen =
      detect(stray, AprilTagGrid{6, 4, april_grid.tag_m, april_grid.spacing});
  EXPECT_EQ(std::count(seen.ids_beyond.begin(), seen.ids_beyond.end(), 27), 0);
}

TEST_F(RenderedBoards, ReasonsAreMeasured) {
  const BoardCamera camera = usual_camera(rendered_chessboard, 0.4);
  const cv::Mat sharp = photograph(draw(rendered_chessboard), camera);
  const auto reason = [&](const cv::Mat& image) {
    return detect(image, rendered_chessboard).reason;
  };
  EXPECT_EQ(reason(cv::Mat(480, 640, CV_8U, 255.0)),
            "no 9x6 board found; over-exposed: 100 % of the pixels are white");
  EXPECT_EQ(reason(cv::Mat(480, 640, CV_8U, 120.0)),
            "no 9x6 board found; low contrast: grey values of 120 to 120");
  EXPECT_EQ(reason(cv::Mat(480, 640, CV_8U, 3.0)),
            "no 9x6 board found; under-exposed: nine tenths of the pixels are at 3 or below");
  cv::Mat blurred;
  cv::GaussianBlur(sharp, blurred, {0, 0}, 14);
  EXPECT_NE(reason(blurred).find("blurred: its sharpest edges are"), std::string::npos)
      << reason(blurred);
  BoardCamera aside = camera;
  aside.t.x() += 0.12;
  EXPECT_NE(reason(photograph(draw(rendered_chessboard), aside))
                .find("the board is cut off by the image's border"),
            std::string::npos)
      << reason(photograph(draw(rendered_chessboard), aside));
}

TEST_F(RenderedBoards, DamagedFilesAreNamed) {
  const cv::Mat image =
      photograph(draw(rendered_chessboard), usual_camera(rendered_chessboard, 0.4));
  const auto error_output = [&](const std::string& name, auto damage) {
    const auto file = save(image, name);
    std::string bytes = read_whole(file);
    damage(bytes);
    write_atomically(file, bytes);
    try {
      detect_board(file, rendered_chessboard);
    } catch (const Error& error) {
      return std::string(error.what()).substr(file.string().size());
    }
    return std::string("none");
  };
  const auto cut = [](std::string& bytes) { bytes.resize(bytes.size() * 2 / 3); };
  EXPECT_EQ(error_output("a1.png", cut),
            ": is cut off (its PNG data have no end); copy it again, or leave it out");
  EXPECT_EQ(error_output("a1.jpg", cut),
            ": is cut off (its JPEG data have no end); copy it again, or leave it out");
  EXPECT_EQ(error_output("a1.pgm", cut),
            ": is cut off (it has fewer pixels than its header says); copy it again, or leave it "
            "out");
  EXPECT_EQ(error_output("a1.png", [](std::string& bytes) { bytes[bytes.size() / 2] ^= 1; })
                .find(": is damaged (libpng: "),
            0u);
  EXPECT_EQ(error_output("a1.png", [](std::string& bytes) { bytes = "text"; }),
            ": is not an image that can be read; check the file");
  EXPECT_EQ(error_output("a1.png", [](std::string& bytes) { bytes.clear(); }),
            ": is not an image that can be read; check the file");
  EXPECT_EQ(error_output("a1.png", [](std::string&) {}), "none");
  EXPECT_EQ(error_output("a1.jpg", [](std::string&) {}), "none");
}

TEST_F(RenderedBoards, ImagesOfAnotherSizeAreAnError) {
  const BoardCamera camera = usual_camera(rendered_chessboard, 0.4);
  const cv::Mat image = photograph(draw(rendered_chessboard), camera);
  save(image, "left01.png");
  save(image(cv::Rect(0, 0, 630, 480)), "left02.png");
  try {
    detect_images({(folder_ / "left*.png").string()}, rendered_chessboard);
    FAIL() << "no Error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("its size 630x480 differs from the images before it"),
              std::string::npos)
        << error.what();
  }
}

/// Views by a pair, some of them in part, and what they were made with.
struct BoardPair {
  BoardObservations observations;
  ImageDetections found;
  Eigen::Vector3d right_t;
  double f_px = 0;
};

BoardPair photograph_pair(const std::filesystem::path& folder) {
  BoardPair pair;
  const test::BoardDrawing drawing = test::draw(april_grid, 2);
  pair.right_t = {-0.12, 0, 0};
  int frame = 0;
  for (const auto& [tilt_x, tilt_y, x] : {std::tuple{0.5, 0.1, 0.0},
                                          {-0.5, 0.2, 0.2},
                                          {0.1, 0.5, 0.3},
                                          {0.0, -0.5, 0.0},
                                          {0.4, -0.4, 0.12},
                                          {-0.3, -0.4, -0.05},
                                          {0.3, 0.5, 0.06}}) {
    BoardCamera camera =
        camera_before(middle_of(april_grid), 0.6, std::numbers::pi + tilt_x, tilt_y, 0.2);
    camera.t.x() += x;
    ++frame;
    for (const std::string side : {"left", "right"}) {
      pair.f_px = camera.f_px;
      const cv::Mat image = photograph(drawing, camera);
      cv::imwrite((folder / (side + std::to_string(frame) + ".png")).string(), image);
      camera.t += pair.right_t;
    }
  }
  pair.found = detect_images({(folder / "left*.png").string(), (folder / "right*.png").string()},
                             BoardTarget(april_grid));
  return pair;
}

TEST_F(RenderedBoards, PartialViewsCalibrateFromImagesAloneAndSurviveTheCornersFile) {
  const BoardPair pair = photograph_pair(folder_);
  const BoardObservations& before = pair.found.observations;
  ASSERT_EQ(before.views.size(), 14u);
  EXPECT_TRUE(std::any_of(before.views.begin(), before.views.end(),
                          [](const BoardView& view) { return view.ids.size() < 100; }));
  const RigEstimate estimate = calibrate(before);
  EXPECT_NEAR(estimate.rig.cameras[0].f_px(), pair.f_px, 0.5);
  EXPECT_NEAR((estimate.rig.T_camera_first[1].t - pair.right_t).norm(), 0, 3e-4);
  EXPECT_LT(estimate.calibration->rms_px, 0.1);

  write_corners(pair.found, april_grid, folder_ / "corners.vnl");
  const BoardObservations after = read_corners(folder_ / "corners.vnl", april_grid, {{640, 480}});
  ASSERT_EQ(after.views.size(), before.views.size());
  for (std::size_t i = 0; i < after.views.size(); ++i) {
    EXPECT_EQ(after.views[i].ids, before.views[i].ids);
    EXPECT_EQ(after.views[i].pixels_px, before.views[i].pixels_px);
    EXPECT_EQ(after.views[i].camera, before.views[i].camera);
  }
}

}  // namespace
}  // namespace vernier
