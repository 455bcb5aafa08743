// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/outliers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "calib/board/board_warp.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/simulated_board.h"
#include "calib/statistics/random.h"
#include "tests/support/board_defects.h"
#include "tests/support/error_message.h"
#include "tests/support/rig_distance.h"
#include "tests/support/scenes.h"
#include "tests/support/wide_views.h"

namespace vernier {

using namespace vernier::internal;

namespace {

using test::worst_sigmas;

using CornerName = std::tuple<int, int, int>;  // frame, camera, corner

std::set<CornerName> names_of(const std::vector<CornerOutlier>& outliers) {
  std::set<CornerName> names;
  for (const CornerOutlier& o : outliers) names.emplace(o.frame, o.camera, o.id);
  return names;
}

std::set<CornerName> corners_of(const BoardView& view) {
  std::set<CornerName> names;
  for (const int id : view.ids) names.emplace(view.frame, view.camera, id);
  return names;
}

TEST(Outliers, AreListedAndTheRestDecides) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 18, .frames = 20});
  BoardObservations spoilt = board.observations, clean = board.observations;
  std::map<CornerName, double> expected;                      // how far it was moved, px
  for (std::size_t v = 0; v < spoilt.views.size(); v += 3) {  // one corner in 160, 3 to 40 px
    BoardView& view = spoilt.views[v];
    const std::size_t i = (7 * v) % view.ids.size();
    const double angle = static_cast<double>(v), far = 3 + 37.0 * static_cast<double>(v) / 40;
    view.pixels_px[i] += far * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    expected[{view.frame, view.camera, view.ids[i]}] = far;
    clean.views[v].ids.erase(clean.views[v].ids.begin() + static_cast<long>(i));
    clean.views[v].pixels_px.erase(clean.views[v].pixels_px.begin() + static_cast<long>(i));
  }
  const RigEstimate robust = calibrate(spoilt), reference = calibrate(clean);
  ASSERT_EQ(robust.calibration->outliers.size(), expected.size());
  for (const CornerOutlier& o : robust.calibration->outliers) {
    const auto found = expected.find({o.frame, o.camera, o.id});
    ASSERT_NE(found, expected.end()) << o.frame << " " << o.camera << " " << o.id;
    EXPECT_NEAR(o.residual_px, found->second, 5 * 0.2);  // its noise
  }
  EXPECT_LT(worst_sigmas(robust.rig, reference.rig, *reference.covariance_mvb), 1e-5);
  EXPECT_TRUE(reference.calibration->outliers.empty());
  const RigEstimate plain = calibrate(spoilt, {.reject_outliers = false});
  EXPECT_GT(worst_sigmas(plain.rig, reference.rig, *reference.covariance_mvb), 3);
}

/// Without the views that hold outliers.
BoardObservations without_views_of(const std::vector<CornerOutlier>& outliers,
                                   BoardObservations observations) {
  std::erase_if(observations.views, [&](const BoardView& view) {
    return std::any_of(outliers.begin(), outliers.end(), [&](const CornerOutlier& o) {
      return o.frame == view.frame && o.camera == view.camera;
    });
  });
  return observations;
}

// Six corners of a column, and a block: the nearest corners that were seen are wrong as well.
TEST(Outliers, WrongCornersSideBySideDoNotHideEachOther) {
  const Chessboard target;
  const auto board = simulate_board(test::stereo_rig(), target, {.seed = 19, .frames = 12});
  BoardObservations spoilt = board.observations;
  std::set<CornerName> wrong;
  for (const bool block : {false, true}) {
    BoardView& view = spoilt.views[block ? 9 : 4];
    BoardView left{view.frame, view.camera, view.image, {}, {}};
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      const int column = view.ids[i] % target.columns, row = view.ids[i] / target.columns;
      const bool moved =
          block ? column >= 4 && column <= 6 && row >= 1 && row <= 3 : column == 4 && row < 6;
      const bool unseen = !block && !moved && column >= 3 && column <= 5;
      if (unseen) continue;
      left.ids.push_back(view.ids[i]);
      left.pixels_px.push_back(view.pixels_px[i]);
      if (!moved) continue;
      left.pixels_px.back() += Eigen::Vector2d(11, -9);
      wrong.emplace(view.frame, view.camera, view.ids[i]);
    }
    view = left;
  }
  const RigEstimate estimate = calibrate(spoilt, {});
  EXPECT_EQ(names_of(estimate.calibration->outliers), wrong);
  EXPECT_NEAR(estimate.calibration->pixel_sigma_px, 0.2, 0.02);
}

// One of 24 views shifted by 11 px, as by a late shutter. Each view of its frame fits a board by
// itself and the two together do not: which one is wrong, no residual tells, and either or both
// may go. Least squares, where the search begins, may bend the rig and the poses until no view
// stands out: of seeds 19 to 24 that is so with 21 and 22 (docs/calibration.md, "Outliers"). It
// must not become more often.
TEST(Outliers, AWholeFrameOfAPairMayBeOne) {
  int found = 0;
  for (std::uint64_t seed = 19; seed < 25; ++seed) {
    const auto board = simulate_board(test::stereo_rig(), {}, {.seed = seed, .frames = 12});
    BoardObservations spoilt = board.observations;
    for (auto& q : test::view_of(spoilt, 4, 1).pixels_px) q += Eigen::Vector2d(6, -9);
    const RigEstimate e = calibrate(spoilt);
    const std::vector<CornerOutlier>& outliers = e.calibration->outliers;
    if (outliers.empty()) continue;
    ++found;
    const BoardObservations kept = without_views_of(outliers, spoilt);
    std::set<CornerName> whole_views;
    for (const int camera : {0, 1}) {
      if (std::any_of(kept.views.begin(), kept.views.end(), [&](const BoardView& view) {
            return view.frame == 4 && view.camera == camera;
          })) {
        continue;
      }
      whole_views.merge(corners_of(test::view_of(spoilt, 4, camera)));
    }
    EXPECT_EQ(names_of(outliers), whole_views) << seed;  // of no other frame, and no part of one
    EXPECT_LT(worst_sigmas(e.rig, calibrate(kept).rig, *e.covariance_mvb), 1e-4) << seed;
  }
  EXPECT_GE(found, 4);
}

// Where two other cameras saw the frame they tell which view is wrong.
TEST(Outliers, AWholeViewMayBeOne) {
  Rig rig = test::stereo_rig();
  rig.cameras.push_back(rig.cameras[0]);
  rig.cameras[2].name = "third";
  rig.T_camera_first.push_back({rotation_from_vector({0.01, 0.02, 0}), {-0.1, -0.1, 0}});
  for (std::uint64_t seed = 19; seed < 25; ++seed) {
    BoardObservations spoilt =
        simulate_board(rig, {}, {.seed = seed, .frames = 12, .distance_m = 1.2}).observations;
    BoardView& view = test::view_of(spoilt, 4, 1);
    for (auto& q : view.pixels_px) q += Eigen::Vector2d(6, -9);
    const RigEstimate e = calibrate(spoilt);
    EXPECT_EQ(names_of(e.calibration->outliers), corners_of(view)) << seed;
    const BoardObservations clean = without_views_of(e.calibration->outliers, spoilt);
    EXPECT_LT(worst_sigmas(e.rig, calibrate(clean).rig, *e.covariance_mvb), 1e-4) << seed;
  }
}

// Corners of one image that are on no plane: they do not stop the calibration from the others.
TEST(Outliers, AnImageThatFitsNoBoardIsLeftOutAndNamed) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 23, .frames = 20});
  for (const double share : {0.3, 1.0}) {
    BoardObservations spoilt = board.observations, clean = board.observations;
    BoardView& view = spoilt.views[9];
    std::set<CornerName> wrong;
    RandomStream draws({.seed = 24, .source = 200});
    clean.views[9].ids.clear();
    clean.views[9].pixels_px.clear();
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      if (static_cast<double>(i % 10) < 10 * share) {
        view.pixels_px[i] += 40 * draws.normals(2);
        wrong.emplace(view.frame, view.camera, view.ids[i]);
      } else {
        clean.views[9].ids.push_back(view.ids[i]);
        clean.views[9].pixels_px.push_back(view.pixels_px[i]);
      }
    }
    if (clean.views[9].ids.empty()) clean.views.erase(clean.views.begin() + 9);
    const RigEstimate found = calibrate(spoilt), reference = calibrate(clean);
    const std::set<CornerName> left_out = names_of(found.calibration->outliers);
    EXPECT_TRUE(std::includes(left_out.begin(), left_out.end(), wrong.begin(), wrong.end()));
    EXPECT_LE(left_out.size(), 54u);
    EXPECT_LT(worst_sigmas(found.rig, reference.rig, *reference.covariance_mvb), 0.5) << share;
    const auto& doubts = found.calibration->trust_warnings;
    ASSERT_EQ(doubts.size(), 1u);
    EXPECT_NE(doubts[0].find("frame 4, camera 1: its corners do not fit a flat board"),
              std::string::npos);
  }
}

// Plain least squares with views numbered the wrong way round, or swapped, ends so far away that
// least squares without them, begun there, finds another valley.
TEST(Outliers, LeastSquaresBeginsAgainAtTheRobustMinimum) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 25, .frames = 12});
  BoardObservations turned = board.observations, swapped = board.observations;
  test::half_turn(test::view_of(turned, 1, 1));
  test::exchange(swapped, 1);
  for (const BoardObservations& spoilt : {turned, swapped}) {
    const RigEstimate e = calibrate(spoilt, {.check_input = false});
    const BoardObservations kept = without_views_of(e.calibration->outliers, spoilt);
    EXPECT_LT(kept.views.size(), spoilt.views.size());
    EXPECT_LT(worst_sigmas(e.rig, calibrate(kept).rig, *e.covariance_mvb), 1e-4);
    EXPECT_LT(worst_sigmas(e.rig, test::stereo_rig(), *e.covariance_mvb), 4.5);
  }
}

TEST(Outliers, ALensThatTheModelDoesNotFitLosesNoCorner) {
  const Rig truth = test::stereo_rig(OpenCv5{});
  const auto board = simulate_board(truth, {}, {.seed = 20, .pixel_sigma_px = 0.05});
  EXPECT_TRUE(calibrate(board.observations, {.model = Pinhole{}}).calibration->outliers.empty());
}

// Residuals grow towards the edge of the image, so that the outermost corners stand out, and those
// beside them once these are out. Of six sets without a wrong corner, the first look alone excludes
// 63, and a look again at every corner that stands out from those that stay 109.
TEST(Outliers, ALensThatTheModelDoesNotFitIsNotErodedFromItsEdge) {
  std::size_t lost = 0;
  for (const double most_deg : {60.0, 65.0, 70.0}) {
    for (const std::uint64_t seed : {7u, 8u}) {
      const BoardObservations seen =
          test::wide_views(
              test::wide_rig(),
              {.most_deg = most_deg, .seed = seed, .square_m = 0.05, .from_axis_deg = 50})
              .observations;
      lost += calibrate(seen, {.model = OpenCv4{}}).calibration->outliers.size();
    }
  }
  RecordProperty("lost", static_cast<int>(lost));
  EXPECT_LE(lost, 75u);
}

TEST(Outliers, AreAsFarAwayAsTheFinalCalibrationPredicts) {
  const Rig truth = test::stereo_rig(OpenCv5{});  // which the radial1 to be fitted is not
  BoardObservations spoilt = simulate_board(truth, {}, {.seed = 18, .frames = 15}).observations;
  for (std::size_t v = 0; v < spoilt.views.size(); v += 4) {
    spoilt.views[v].pixels_px[3 * v % 54] += Eigen::Vector2d(14, -9);
  }
  for (const BoardWarp warp : {BoardWarp::known, BoardWarp::free}) {
    const RigEstimate e = calibrate(spoilt, {.model = Radial1{}, .warp = warp});
    ASSERT_EQ(e.calibration->outliers.size(), 8u);
    const auto target_m = warped_target(spoilt.target_m, e.evidence->warp_m);
    for (const CornerOutlier& o : e.calibration->outliers) {
      const Pose T = e.rig.T_camera_first[o.camera] * e.evidence->T_first_board[o.frame];
      const Eigen::Vector2d predicted = project(e.rig.cameras[o.camera], T * target_m[o.id]);
      EXPECT_NEAR(o.residual_px, (predicted - o.pixel_px).norm(), 1e-9) << o.frame;
    }
  }
}

// A lens out of focus, or half the resolution: what is much for the one camera is noise of the
// other.
TEST(Outliers, ACameraOfWorseCornersLosesNone) {
  auto board =
      simulate_board(test::stereo_rig(), {}, {.seed = 31, .frames = 14, .pixel_sigma_px = 0.1});
  for (BoardView& view : board.observations.views) {
    if (view.camera == 0) continue;
    RandomStream draws(
        {.seed = 31, .feature = static_cast<std::uint32_t>(view.frame), .source = 200});
    for (auto& pixel : view.pixels_px) pixel += 2 * draws.normals(2);
  }
  BoardObservations spoilt = board.observations;
  EXPECT_EQ(calibrate(board.observations).calibration->outliers.size(), 0u);
  // What is an outlier in the better camera is none in the other.
  for (const int camera : {0, 1}) {
    test::view_of(spoilt, 5, camera).pixels_px[20] += Eigen::Vector2d(3, 3);
  }
  EXPECT_EQ(names_of(calibrate(spoilt).calibration->outliers), (std::set<CornerName>{{5, 0, 20}}));
}

/// Eight of the right camera's 13 views hold few corners, which lie elsewhere.
BoardObservations mostly_displaced(double by_px) {
  BoardObservations spoilt =
      simulate_board(test::stereo_rig(), {}, {.seed = 32, .frames = 13}).observations;
  for (int frame = 5; frame < 13; ++frame) {
    BoardView& view = test::view_of(spoilt, frame, 1);
    view.ids.resize(12);
    view.pixels_px.resize(12);
    const Eigen::Vector2d away(by_px * std::cos(frame), by_px * std::sin(frame));
    for (auto& pixel : view.pixels_px) pixel += away;
  }
  return spoilt;
}

TEST(Outliers, MoreThanHalfOfACamerasViewsAreNotLeftOut) {
  const std::string words =
      "8 of the 13 views of camera 1 (\"right\") do not fit the others, too many to exclude as "
      "outliers: inspect the images of frames 5, 6, 7, 8, 9, 10 and 2 more";
  const RigEstimate e = calibrate(mostly_displaced(4), {.check_input = false});
  EXPECT_EQ(e.calibration->outliers.size(), 0u);
  EXPECT_EQ(e.calibration->trust_warnings, std::vector<std::string>{words});
  // farther away, least squares has no minimum with them
  const std::string error_output =
      test::error_message([] { calibrate(mostly_displaced(8), {.check_input = false}); });
  EXPECT_NE(error_output.find("did not converge"), std::string::npos) << error_output;
  EXPECT_NE(error_output.find(words), std::string::npos) << error_output;
}

TEST(Outliers, FramesAndCamerasThatTheStateDoesNotHaveAreAnError) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 33, .frames = 4});
  BoardObservations strange = board.observations;
  strange.views.back().frame = 9;
  EXPECT_EQ(test::error_message([&] { corner_residuals(strange, board.truth); }),
            "frame 9: it has a view but no board pose; give one board pose for every "
            "frame with views");
  strange = board.observations;
  strange.views.back().camera = 2;
  EXPECT_EQ(test::error_message([&] { corner_residuals(strange, board.truth); }),
            "frame 3: the rig has 2 cameras, so no camera 2; give the corners of this rig");

  std::vector<CornerOutlier> outliers{{9, 0, 0, "", {0, 0}, 0}};
  measure_outliers(board.observations.target_m, board.truth, outliers);
  EXPECT_TRUE(std::isnan(outliers[0].residual_px));
  outliers = {{1, 2, 0, "", {0, 0}, 0}};
  EXPECT_NE(test::error_message([&] {
              measure_outliers(board.observations.target_m, board.truth, outliers);
            }).find("no camera 2"),
            std::string::npos);
  outliers = {{1, 0, 54, "", {0, 0}, 0}};
  EXPECT_NE(test::error_message([&] {
              measure_outliers(board.observations.target_m, board.truth, outliers);
            }).find("the target has no corner 54"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
