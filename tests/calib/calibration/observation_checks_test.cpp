// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/observation_checks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "calib/board/board_homography.h"
#include "calib/board_observations.h"
#include "calib/board_target.h"
#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/simulated_board.h"
#include "calib/statistics/random.h"
#include "tests/support/board_defects.h"
#include "tests/support/error_message.h"
#include "tests/support/scenes.h"
#include "tests/support/wide_views.h"

namespace vernier {

using namespace vernier::internal;

namespace {

std::string complaint_about(BoardObservations observations) {
  return test::error_message([&] {
    check_and_sort(observations);
    check_observations(observations);
  });
}

ObservationDiagnosis diagnosis_of(BoardObservations observations) {
  check_and_sort(observations);
  return check_observations(observations);
}

bool holds(const std::vector<std::string>& list, const std::string& text) {
  return std::any_of(list.begin(), list.end(), [&](const std::string& entry) {
    return entry.find(text) != std::string::npos;
  });
}

class ObservationChecks : public testing::Test {
 protected:
  BoardObservations good_ = simulate_board(test::stereo_rig(), {}, {.seed = 1}).observations;
};

TEST_F(ObservationChecks, GoodOnesPassInSilence) {
  const ObservationDiagnosis diagnosis = diagnosis_of(good_);
  EXPECT_TRUE(diagnosis.trust_warnings.empty());
  EXPECT_TRUE(diagnosis.warnings.empty());
}

TEST_F(ObservationChecks, OneMirroredViewIsNamed) {
  test::mirror(good_.views[5], 9);
  good_.views[5].image = "right02.png";
  EXPECT_EQ(complaint_about(good_),
            "frame 2, camera 1 (right02.png): the board is mirrored against the other 39 views; "
            "corners must run row by row, x right and y down as seen: flip the mirrored images or "
            "reverse their numbering");
}

TEST_F(ObservationChecks, AMirroredCameraIsNamed) {
  for (BoardView& view : good_.views) {
    if (view.camera == 1) test::mirror(view, 9);
  }
  EXPECT_NE(complaint_about(good_).find("camera 1: the board is mirrored in all its 20 views"),
            std::string::npos)
      << complaint_about(good_);
}

TEST_F(ObservationChecks, ABoardMirroredEverywhereIsDoubted) {
  for (BoardView& view : good_.views) test::mirror(view, 9);
  const ObservationDiagnosis diagnosis = diagnosis_of(good_);
  ASSERT_EQ(diagnosis.trust_warnings.size(), 1u);
  EXPECT_EQ(diagnosis.trust_warnings[0].find("every view shows the board mirrored"), 0u);
}

TEST_F(ObservationChecks, AGridOfTagsWithItsYUpwardsIsNoMirroredBoard) {
  // corners of 4 x 3 tags: pairs of columns and rows, the gap a third of a tag
  for (auto& X : good_.target_m) {
    const int column = static_cast<int>(std::lround(X.x() / 0.025));
    const int row = static_cast<int>(std::lround(X.y() / 0.025));
    X = {0.03 * (column / 2) + 0.02 * (column % 2), -0.03 * (row / 2) - 0.02 * (row % 2), 0};
  }
  const SimulatedBoard drawn = simulate_board(test::stereo_rig(), {}, {.seed = 1});
  for (BoardView& view : good_.views) {
    const Pose T = drawn.truth.rig.T_camera_first[view.camera] *
                   drawn.truth.T_first_board[view.frame] *
                   Pose{rotation_from_vector({3.14159265358979, 0, 0}), {0.05, 0.05, 0}};
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      view.pixels_px[i] =
          project(drawn.truth.rig.cameras[view.camera], T * good_.target_m[view.ids[i]]);
    }
  }
  check_and_sort(good_);
  EXPECT_TRUE(check_observations(good_).trust_warnings.empty());
}

TEST_F(ObservationChecks, AMirroredImageIsNamedAsMirroredNumbering) {
  for (auto& pixel : good_.views[0].pixels_px) pixel.x() = 639 - pixel.x();
  EXPECT_NE(complaint_about(good_).find("frame 0, camera 0: the board is mirrored"),
            std::string::npos);
}

TEST_F(ObservationChecks, AViewCountedTwiceIsNamed) {
  test::append_frame(good_, 4, 20);
  EXPECT_EQ(complaint_about(good_),
            "frame 20, camera 0: it is the same view as frame 4 (their corners differ by 0 px), "
            "and counting it twice would understate the uncertainty; remove one of the "
            "two");
}

TEST_F(ObservationChecks, ARepeatedViewWithItsOwnNoiseIsAWarning) {
  test::append_frame(good_, 4, 20);
  RandomStream draws({.seed = 3, .source = 200});
  for (BoardView& view : good_.views) {
    if (view.frame != 20) continue;
    for (auto& pixel : view.pixels_px) pixel += 0.05 * draws.normals(2);
  }
  const ObservationDiagnosis diagnosis = diagnosis_of(good_);
  EXPECT_TRUE(holds(diagnosis.warnings, "the board did not move between frames 4 and 20"));
  EXPECT_TRUE(diagnosis.trust_warnings.empty());
}

TEST_F(ObservationChecks, LeftAndRightFromOneImageAreNamed) {
  good_.views[7].pixels_px = good_.views[6].pixels_px;
  EXPECT_EQ(complaint_about(good_),
            "frame 3, camera 0 and camera 1: the images are the same (their corners differ by 0 "
            "px); give the other camera's own image");
}

TEST_F(ObservationChecks, RowsAndColumnsExchangedAreNamed) {
  good_.target_m = target_points(Chessboard{6, 9, 0.025});
  EXPECT_NE(complaint_about(good_).find("frame 0, camera 0: its corners do not fit a flat board"),
            std::string::npos);
  EXPECT_NE(complaint_about(good_).find("rows and columns of the board are not exchanged"),
            std::string::npos);
}

// A wide lens bends a tilted board by several pixels, far from the spacing of its corners.
TEST_F(ObservationChecks, TiltedBoardsBeforeAWideLensPass) {
  const Rig rig = [] {
    Rig wide = test::stereo_rig(Fisheye4{});
    wide.cameras.resize(1);
    wide.T_camera_first.resize(1);
    wide.cameras[0].parameters << 240, 1, 319.5, 239.5, -0.03, 0.005, 0, 0;
    return wide;
  }();
  const Camera& camera = rig.cameras[0];
  BoardObservations seen{{camera.size_px}, good_.target_m, {}};
  const Eigen::Vector3d middle = 0.5 * (seen.target_m.front() + seen.target_m.back());
  for (const double x : {-0.7, 0.0, 0.7}) {
    for (const double y : {-0.7, 0.0, 0.7}) {
      for (const double along : {-0.08, 0.0, 0.08}) {
        for (const double away : {0.12, 0.15, 0.2}) {
          BoardView view{static_cast<int>(seen.views.size()), 0, "", {}, {}};
          const Eigen::Matrix3d R =
              rotation_from_vector({0, y, 0}) * rotation_from_vector({x, 0, 0});
          for (std::size_t i = 0; i < seen.target_m.size(); ++i) {
            const Eigen::Vector3d X =
                R * (seen.target_m[i] - middle) + Eigen::Vector3d(0, along, away);
            const Eigen::Vector2d pixel = project(camera, X);
            if (X.z() < 0.03 || !in_image(camera, pixel)) continue;
            view.ids.push_back(static_cast<int>(i));
            view.pixels_px.push_back(pixel);
          }
          if (view.ids.size() == seen.target_m.size()) seen.views.push_back(std::move(view));
        }
      }
    }
  }
  EXPECT_GT(seen.views.size(), 20u);
  EXPECT_EQ(complaint_about(seen), "");
}

// So near that the board reaches from the middle of the image to 85 degrees: the residual of a
// homography is half the spacing of the corners.
TEST_F(ObservationChecks, ABoardThatAWideLensBendsByHalfASquarePasses) {
  int bent = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const BoardObservations seen =
        test::wide_views(test::wide_rig(), {.most_deg = 85, .seed = seed}).observations;
    for (const BoardView& view : seen.views) {
      bent += board_homography(seen.target_m, view).rms_px > 18;
    }
    EXPECT_EQ(complaint_about(seen), "");
  }
  EXPECT_GT(bent, 1);
}

// In one view of a wide lens, which bends boards, and of a narrow one.
TEST_F(ObservationChecks, WrongNumberingIsNamedBeforeAnyLens) {
  const BoardObservations wide =
      test::wide_views(test::wide_rig(), {.most_deg = 75, .seed = 2}).observations;
  const auto reverse_rows = [](BoardView& view, int columns, int first, int step) {
    std::map<int, Eigen::Vector2d> pixel;
    for (std::size_t i = 0; i < view.ids.size(); ++i) pixel[view.ids[i]] = view.pixels_px[i];
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      const int row = view.ids[i] / columns, column = view.ids[i] % columns;
      if (row < first || (row - first) % step != 0) continue;
      view.pixels_px[i] = pixel.at(row * columns + columns - 1 - column);
    }
  };
  for (const BoardObservations& good : {good_, wide}) {
    const int columns = good.target_m.size() == 54 ? 9 : 12;
    const std::size_t v =
        static_cast<std::size_t>(std::find_if(good.views.begin() + 2, good.views.end(),
                                              [&](const BoardView& view) {
                                                return view.ids.size() == good.target_m.size();
                                              }) -
                                 good.views.begin());
    const auto complaint_with = [&](const auto& spoil) {
      BoardObservations spoilt = good;
      spoil(spoilt.views[v]);
      const auto doubts = diagnosis_of(spoilt).frame_doubts;
      return std::any_of(doubts.begin(), doubts.end(), [&](const FrameDoubt& doubt) {
        return doubt.frame == good.views[v].frame &&
               doubt.text.find("its corners do not fit a flat board") != std::string::npos;
      });
    };
    EXPECT_FALSE(complaint_with([](BoardView&) {}));
    EXPECT_TRUE(complaint_with([&](BoardView& view) { reverse_rows(view, columns, 0, 100); }));
    EXPECT_TRUE(complaint_with([&](BoardView& view) { reverse_rows(view, columns, 3, 100); }));
    EXPECT_TRUE(complaint_with([&](BoardView& view) { reverse_rows(view, columns, 1, 2); }));
    EXPECT_TRUE(complaint_with([](BoardView& view) {  // each has the next one's number
      view.pixels_px.erase(view.pixels_px.begin() + 3);
      view.ids.pop_back();
    }));
    EXPECT_TRUE(complaint_with([&](BoardView& view) {  // rows and columns exchanged
      const int rows = static_cast<int>(good.target_m.size()) / columns;
      for (int& id : view.ids) id = (id % rows) * columns + id / rows;
    }));
  }
}

TEST_F(ObservationChecks, CornersOnOneLineAreNoView) {
  BoardView& view = test::view_of(good_, 5, 1);
  view.image = "right05.png";
  const BoardView whole = view;
  const auto error_output = [&](const std::vector<int>& ids) {
    view.ids = ids;
    view.pixels_px.clear();
    for (const int id : ids) view.pixels_px.push_back(whole.pixels_px[id]);
    return complaint_about(good_);
  };
  const std::string expected =
      "frame 5, camera 1 (right05.png): all its corners, or all but one, are collinear, which does "
      "not determine the board's pose; leave the view out";
  EXPECT_EQ(error_output({9, 10, 11, 12, 13, 14, 15, 16, 17}), expected);  // a row
  EXPECT_EQ(error_output({0, 10, 20, 30, 40, 50}), expected);              // a diagonal
  EXPECT_EQ(error_output({0, 1, 2, 3, 31}), expected);                     // and one elsewhere
  EXPECT_EQ(error_output({31, 3, 12, 21}), expected);  // four, three in a column
  EXPECT_EQ(error_output({0, 1, 9, 10}), "");
  EXPECT_EQ(error_output({0, 1, 2, 9, 10}), "");
}

TEST_F(ObservationChecks, ATargetThatIsNotFlatIsRefused) {
  for (std::size_t i = 0; i < good_.target_m.size(); ++i) good_.target_m[i].z() = 0.02 * (i % 4);
  EXPECT_EQ(complaint_about(good_).find("target: its corners are not in the plane z = 0"), 0u);
}

TEST_F(ObservationChecks, UnpairedFramesAreCountedAndSaid) {
  std::erase_if(good_.views, [](const BoardView& view) {
    return (view.camera == 1 && view.frame < 3) || (view.camera == 0 && view.frame == 9);
  });
  const ObservationDiagnosis diagnosis = diagnosis_of(good_);
  ASSERT_EQ(diagnosis.warnings.size(), 2u);
  EXPECT_EQ(
      diagnosis.warnings[0].find("3 of 20 frames show the board in camera 0 alone (0, 1 and 2)"),
      0u);
  EXPECT_EQ(diagnosis.warnings[1].find("1 of 20 frames show the board in camera 1 alone (9)"), 0u);
}

TEST_F(ObservationChecks, AnImageSizeTwiceTooLargeIsDoubted) {
  for (auto& size : good_.size_px) size *= 2;
  EXPECT_TRUE(holds(diagnosis_of(good_).trust_warnings, "check the image size"));
}

TEST_F(ObservationChecks, MillimetresAreSuspected) {
  for (auto& X : good_.target_m) X *= 1000;
  EXPECT_TRUE(holds(diagnosis_of(good_).trust_warnings,
                    "the board measures 200 m, its points are 25 m apart: did you mean 0.025?"));
}

}  // namespace
}  // namespace vernier
