// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/uncertainty/next_view.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "calib/board/board_placement.h"
#include "calib/board_observations.h"
#include "calib/board_target.h"
#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/simulated_board.h"
#include "calib/triangulation_uncertainty.h"
#include "calib/uncertainty/target_quantity.h"
#include "tests/support/dense_oracles.h"
#include "tests/support/error_message.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

constexpr double view_sigma_px = 0.2;

SimulatedBoard first_views(double noise_px, int frames = 8) {
  return simulate_board(test::stereo_rig(), {},
                        {.seed = 11, .frames = frames, .pixel_sigma_px = noise_px});
}

RigEstimate calibrated(const BoardObservations& observations) {
  return calibrate(observations, {.pixel_sigma_px = view_sigma_px, .white_noise = true});
}

std::vector<CandidateView> candidates_of(const Rig& rig, const PlacementOptions& options = {}) {
  return candidate_views(rig, target_points({}), {0, 0}, view_sigma_px, options);
}

/// The observations with a noise-free view of a placement added.
BoardObservations with_view(BoardObservations observations, const Rig& truth, const Pose& T) {
  const int frame = observations.views.back().frame + 1;
  for (int c = 0; c < static_cast<int>(truth.cameras.size()); ++c) {
    BoardView view{frame, c, "", {}, {}};
    for (std::size_t i = 0; i < observations.target_m.size(); ++i) {
      view.ids.push_back(static_cast<int>(i));
      view.pixels_px.push_back(
          project(truth.cameras[c], truth.T_camera_first[c] * (T * observations.target_m[i])));
    }
    observations.views.push_back(view);
  }
  return observations;
}

// The prediction is linear at the estimate; noise-free views leave the estimate where it was, so a
// calibration with the advised views has exactly the predicted bound.
TEST(NextView, PredictsTheBoundOfTheCalibrationWithIt) {
  const SimulatedBoard board = first_views(0);
  const RigEstimate before = calibrated(board.observations);
  for (const char* what : {"depth", "projection", "rectification", "baseline", "left.f_px"}) {
    const TargetQuantity wanted = target_quantity(before.rig, what, 5);
    const ViewAdvice advice =
        advise_views(ScaledDecomposition(*before.covariance).factor(), candidates_of(before.rig),
                     wanted, {.views = 2, .more = 2});
    BoardObservations more = board.observations;
    for (const ScoredView& view : advice.views) {
      more = with_view(more, board.truth.rig, view.placement.T_first_board);
      const RigEstimate after = calibrated(more);
      const double sd = sd_of(target_quantity(after.rig, what, 5),
                              ScaledDecomposition(*after.covariance).factor());
      EXPECT_NEAR(view.sd_after / sd, 1, 1e-5) << what;
      EXPECT_LT(view.sd_after, view.sd_before) << what;
    }
    EXPECT_EQ(advice.views[1].sd_before, advice.views[0].sd_after);
  }
}

// With noise in the first views the estimate moves a little when the new one comes.
TEST(NextView, PredictsTheBoundWithinAFewPerCentUnderNoise) {
  const SimulatedBoard board = first_views(view_sigma_px);
  const RigEstimate before = calibrated(board.observations);
  const ViewAdvice advice =
      advise_views(ScaledDecomposition(*before.covariance).factor(), candidates_of(before.rig),
                   target_quantity(before.rig, "depth", 5), {.more = 1});
  const RigEstimate after = calibrated(
      with_view(board.observations, board.truth.rig, advice.views[0].placement.T_first_board));
  EXPECT_NEAR(
      depth_uncertainty(after, {5}, {.samples = 2})[0].sigma_linear_m / advice.views[0].sd_after, 1,
      0.03);
}

TEST(NextView, UpdateIsTheSumOfInformations) {
  const RigEstimate estimate = calibrated(first_views(0).observations);
  const Eigen::MatrixXd F = ScaledDecomposition(*estimate.covariance).factor();
  const auto candidates = candidates_of(estimate.rig, {.places = 2, .angles = 3});
  const Eigen::MatrixXd& S = candidates.front().information;
  const Eigen::MatrixXd C = estimate.covariance->matrix;
  const Eigen::VectorXd d = C.diagonal().cwiseSqrt();
  // scaled, so that inverses are safe
  const Eigen::MatrixXd R = d.cwiseInverse().asDiagonal() * C * d.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd T = d.asDiagonal() * S * d.asDiagonal();
  const Eigen::MatrixXd expected = test::inverse(test::inverse(R) + 3 * T);
  const Eigen::MatrixXd updated = d.cwiseInverse().asDiagonal() * updated_factor(F, S, 3);
  EXPECT_LT((updated * updated.transpose() - expected).norm(), 1e-7 * expected.norm());
}

TEST(NextView, HeldParametersStayHeld) {
  RigEstimate estimate = calibrated(first_views(0).observations);
  estimate.covariance->matrix.row(1).setZero();
  estimate.covariance->matrix.col(1).setZero();
  const Eigen::MatrixXd F = ScaledDecomposition(*estimate.covariance).factor();
  const auto candidates = candidates_of(estimate.rig, {.places = 3, .angles = 3});
  EXPECT_EQ(updated_factor(F, candidates[0].information).row(1).norm(), 0);
  EXPECT_NE(test::error_message(
                [&] { advise_views(F, candidates, target_quantity(estimate.rig, "left.ax", 5)); })
                .find("left.ax: its standard deviation is already 0: the parameters it depends on "
                      "are fixed"),
            std::string::npos);
}

TEST(NextView, RatesEveryCandidate) {
  const RigEstimate estimate = calibrated(first_views(0).observations);
  const Eigen::MatrixXd F = ScaledDecomposition(*estimate.covariance).factor();
  const auto candidates = candidates_of(estimate.rig);
  const TargetQuantity wanted = target_quantity(estimate.rig, "depth", 5);
  const ViewAdvice advice = advise_views(F, candidates, wanted);
  double best = 1e9, worst = 0;
  for (const CandidateView& view : candidates) {
    const double sd = sd_of(wanted, updated_factor(F, view.information));
    best = std::min(best, sd);
    worst = std::max(worst, sd);
  }
  EXPECT_NEAR(advice.views[0].sd_after, best, 1e-9 * best);
  EXPECT_NEAR(advice.worst_candidate.sd_after, worst, 1e-9 * worst);
  EXPECT_EQ(advice.alternatives.size(), 5u);
  EXPECT_EQ(advice.sd_after_more.size(), 10u);
  for (std::size_t i = 1; i < 10; ++i) {
    EXPECT_LT(advice.sd_after_more[i], advice.sd_after_more[i - 1]);
  }
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_GE(advice.alternatives[i].sd_after, i ? advice.alternatives[i - 1].sd_after : best);
  }
}

TEST(BoardPlacements, AreSeenWholeByEveryCamera) {
  const Rig rig = test::stereo_rig();
  const auto target = target_points({});
  const auto boards = placed_boards(rig, target);
  EXPECT_GT(boards.size(), 100u);
  for (const PlacedBoard& board : boards) {
    ASSERT_EQ(board.views.size(), 2u);
    for (const BoardView& view : board.views) EXPECT_EQ(view.pixels_px.size(), target.size());
    const Eigen::Vector3d middle =
        board.placement.T_first_board * (0.5 * (target.front() + target.back()));
    EXPECT_LT((project(rig.cameras[0], middle) - board.placement.centre_px).norm(), 1e-6);
    EXPECT_NEAR(middle.norm(), board.placement.distance_m, 1e-9);
  }
  EXPECT_GT(placed_boards(rig, target, {.partly = true}).size(), boards.size());
}

TEST(BoardPlacements, WordsSayWhichEdgeIsNearer) {
  const Rig rig = test::stereo_rig();
  const auto target = target_points({});
  for (const PlacedBoard& board : placed_boards(rig, target)) {
    const Pose& T = board.placement.T_first_board;
    const std::string words = describe_placement(board.placement, rig.cameras[0]);
    const auto says = [&](const char* edge) { return words.find(edge) != std::string::npos; };
    // corner 8 ends the first row, 45 begins the last
    const double rightwards = (T * target[8]).z() - (T * target[0]).z();
    const double downwards = (T * target[45]).z() - (T * target[0]).z();
    EXPECT_EQ(says("right edge nearer"), rightwards < -1e-9) << words;
    EXPECT_EQ(says("left edge nearer"), rightwards > 1e-9) << words;
    EXPECT_EQ(says("upper edge nearer"), downwards > 1e-9) << words;
    EXPECT_EQ(says("lower edge nearer"), downwards < -1e-9) << words;
  }
  BoardPlacement p;
  p.centre_px = {480, 120};
  p.distance_m = 0.55;
  p.turn_rad = 0.611;
  EXPECT_EQ(
      describe_placement(p, rig.cameras[0]),
      "hold the board 0.55 m away, its centre in the upper right of the left image (480, 120), "
      "turned 35° about the vertical axis (right edge nearer), tilted 0°");
}

TEST(BoardPlacements, RefuseABoardThatFitsNowhere) {
  Rig rig = test::stereo_rig();
  rig.T_camera_first[1].t.x() = -2;
  EXPECT_EQ(
      test::error_message([&] {
        placed_boards(rig, target_points(Chessboard{9, 6, 0.01}));
      }),
      "board: no placement shows it whole in all cameras; use a larger board farther away, or let "
      "one camera see a part of it (--partly)");
  EXPECT_NE(test::error_message([&] {
              placed_boards(rig, target_points(Chessboard{9, 1, 0.01}));
            }).find("board: its corners are collinear"),
            std::string::npos);
}

TEST(TargetQuantity, DepthIsThatOfDepthUncertainty) {
  const RigEstimate estimate = calibrated(first_views(view_sigma_px).observations);
  for (const double range : {1.0, 5.0, 20.0}) {
    const double sd = sd_of(target_quantity(estimate.rig, "depth", range),
                            ScaledDecomposition(*estimate.covariance).factor());
    EXPECT_NEAR(sd / depth_uncertainty(estimate, {range}, {.samples = 2})[0].sigma_linear_m, 1,
                1e-4);
  }
}

// A shift of one image's rows by ε px is a vertical disparity of ε everywhere; a turn about the
// baseline of both, none.
TEST(TargetQuantity, RectificationSeesWhatPartsTheRows) {
  Rig rig = test::stereo_rig(Pinhole{});
  rig.T_camera_first[1].R.setIdentity();
  rig.T_camera_first[1].t = {-0.2, 0, 0};
  const TargetQuantity wanted = target_quantity(rig, "rectification", 3);
  const auto names = parameter_names(rig);
  const auto column = [&](const std::string& name) {
    const auto at = std::find(names.begin(), names.end(), name) - names.begin();
    return Eigen::VectorXd(wanted.gradient.col(at));
  };
  EXPECT_GT(column("right.oy_px").minCoeff(), 0.9);
  EXPECT_LT(column("right.oy_px").maxCoeff(), 1.1);
  EXPECT_LT(column("right.tx_m").cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(wanted.unit, "px");
}

TEST(TargetQuantity, RefusesWhatIsNoError) {
  const Rig rig = test::stereo_rig();
  const std::string unknown = test::error_message([&] { target_quantity(rig, "sharpness", 5); });
  EXPECT_NE(unknown.find("\"sharpness\": unknown quantity; supported: depth, projection, "
                         "rectification, baseline or a parameter: left.f_px"),
            std::string::npos)
      << unknown;
  Rig one = rig;
  one.cameras.resize(1);
  one.T_camera_first.resize(1);
  EXPECT_EQ(test::error_message([&] { target_quantity(one, "depth", 5); }),
            "depth: it needs a pair and the rig has 1 camera; choose projection or a parameter");
  EXPECT_GT(target_quantity(one, "projection", 5).gradient.rows(), 10);
  EXPECT_NE(test::error_message([&] { target_quantity(rig, "depth", -1); }).find("above 0"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
