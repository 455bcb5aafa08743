// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/board_aspect.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "calib/calibrate.h"
#include "calib/calibration/effects.h"
#include "calib/calibration/solve_again.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "calib/simulated_board.h"
#include "tests/support/bent_board.h"
#include "tests/support/error_message.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

constexpr double stretch = 0.004;

/// A square board, turned by 90 degrees in every second frame.
SimulatedBoard turned_board(int frames, std::uint32_t trial = 0) {
  return test::turned(simulate_board(
      test::stereo_rig(), {6, 6, 0.025},
      {.seed = 8201, .trial = trial, .poses = trial, .frames = frames, .pixel_sigma_px = 0.1}));
}

BoardObservations stretched(const SimulatedBoard& board) {
  return test::of_points(board, stretched_target(board.observations.target_m, stretch));
}

double squared_distance(const Rig& rig, const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd error = difference(rig, test::stereo_rig());
  return error.dot(covariance.ldlt().solve(error));
}

double squared_distance(const RigEstimate& estimate) {
  return squared_distance(estimate.rig, estimate.covariance->matrix);
}

const RigEstimate& with_aspect() {
  static const RigEstimate estimate =
      calibrate(stretched(turned_board(14)), {.board_aspect = true});
  return estimate;
}

TEST(BoardAspect, StretchesAboutTheMeanAndAdds) {
  const std::vector<Eigen::Vector3d> target_m = target_points(Chessboard{4, 3, 0.1});
  const auto once = stretched_target(target_m, 0.3);
  const auto twice = stretched_target(stretched_target(target_m, 0.1), 0.2);
  const double h = 1e-6;
  const auto before = stretched_target(target_m, -h), after = stretched_target(target_m, h);
  const Eigen::Matrix3Xd by_aspect = aspect_field(target_m);
  for (std::size_t i = 0; i < target_m.size(); ++i) {
    EXPECT_LT((once[i] - twice[i]).norm(), 1e-15);
    EXPECT_NEAR(once[i].x() * once[i].y(), target_m[i].x() * target_m[i].y(), 1e-15);
    const Eigen::Vector3d slope = (after[i] - before[i]) / (2 * h);
    EXPECT_LT((slope - by_aspect.col(static_cast<Eigen::Index>(i))).norm(), 1e-9);
  }
  EXPECT_NEAR(once.back().x() / once.back().y() / (target_m.back().x() / target_m.back().y()),
              std::exp(0.3), 1e-12);
}

// The aspect to four of its standard deviations, one in 16 000; the rig to 45 of 16, one in 7000.
TEST(BoardAspect, IsEstimatedWithTheRig) {
  const AspectEstimate& aspect = *with_aspect().calibration->board_aspect;
  EXPECT_NEAR(aspect.value, stretch, 4 * aspect.sigma);
  EXPECT_LT(aspect.sigma, 5e-4);
  EXPECT_LT(squared_distance(with_aspect()), 45);
  const RigEstimate without = calibrate(stretched(turned_board(14)));
  const Eigen::MatrixXd& C = with_aspect().covariance->matrix;
  EXPECT_GT(squared_distance(without.rig, C), 2 * squared_distance(with_aspect().rig, C));
  EXPECT_EQ(without.calibration->trust_warnings, std::vector<std::string>{});
  EXPECT_GT(without.calibration->rms_px, with_aspect().calibration->rms_px);
}

// Which of x and y is as given is open: the scale of the rig is, by half of the aspect.
TEST(BoardAspect, LeavesTheScaleOpen) {
  const Eigen::Vector3d T = with_aspect().rig.T_camera_first[1].t;
  const int at = pose_index(with_aspect().rig, 1) + 3;
  const auto along = [&](const Eigen::MatrixXd& C) {
    return T.normalized().dot(C.block<3, 3>(at, at) * T.normalized());
  };
  const double open = std::pow(0.5 * with_aspect().calibration->board_aspect->value * T.norm(), 2);
  EXPECT_GT(along(with_aspect().covariance->matrix), open);
  EXPECT_LT(along(*with_aspect().covariance_mvb), open);
}

TEST(BoardAspect, IsFoundWhereItIsAndToldWhereItIsNot) {
  CalibrationOptions options;
  EffectsTest test;
  const BoardObservations seen = stretched(turned_board(14));
  const RigEstimate found = with_found_effects(calibrate(seen), seen, options, test);
  EXPECT_TRUE(options.board_aspect && test.has_aspect() && test.tells_aspect());
  EXPECT_FALSE(options.board_shape || options.motion);
  EXPECT_EQ(parameters(found.rig), parameters(with_aspect().rig));

  const BoardObservations square = turned_board(14).observations;
  CalibrationOptions of_square;
  const RigEstimate usual = with_found_effects(calibrate(square), square, of_square, test);
  EXPECT_FALSE(of_square.board_aspect || usual.calibration->board_aspect);
  EXPECT_TRUE(test.tells_aspect());
}

// Boards that are never turned leave it to fx and fy.
TEST(BoardAspect, IsNotToldByBoardsThatAreNotTurned) {
  const SimulatedBoard board =
      simulate_board(test::stereo_rig(), {6, 6, 0.025}, {.seed = 8202, .frames = 8});
  CalibrationOptions options;
  EffectsTest test;
  const RigEstimate usual =
      with_found_effects(calibrate(board.observations), board.observations, options, test);
  EXPECT_FALSE(options.board_aspect);
  ASSERT_TRUE(test.aspect);
  EXPECT_FALSE(test.tells_aspect());
  EXPECT_GT(test.aspect->sigma, 1e-3);
}

// A rig file keeps it, and its target is the stretched one: solved again, it stays where it is.
TEST(BoardAspect, IsSolvedAgainFromARigFile) {
  const RigEstimate read = parse_rig(format_rig(with_aspect()), "rig.json").estimate;
  EXPECT_EQ(read.calibration->board_aspect->value, with_aspect().calibration->board_aspect->value);
  EXPECT_EQ(read.calibration->board_aspect->sigma, with_aspect().calibration->board_aspect->sigma);
  const CalibrationOptions how = options_to_solve_again(read);
  EXPECT_TRUE(how.board_aspect);
  const RigEstimate again = calibrate(read.evidence->observations, how);
  const Eigen::VectorXd sd = read.covariance_mvb->diagonal().cwiseSqrt();
  EXPECT_LT(difference(again.rig, read.rig).cwiseQuotient(sd).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_LT(std::abs(again.calibration->board_aspect->value),
            1e-4 * read.calibration->board_aspect->sigma);
  EXPECT_LT((*again.covariance_mvb - *read.covariance_mvb)
                .cwiseQuotient(sd * sd.transpose())
                .cwiseAbs()
                .maxCoeff(),
            1e-4);
  const RigEstimate known = without_effects(read);
  EXPECT_FALSE(known.calibration->board_aspect);
  EXPECT_LT(difference(known.rig, read.rig).cwiseQuotient(sd).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_LT((*known.covariance_mvb)(1, 1), (*read.covariance_mvb)(1, 1));
}

TEST(BoardAspect, LeavesNoPlaceForAWarpOrAGivenNoise) {
  const BoardObservations seen = turned_board(4).observations;
  const auto fault = [&](CalibrationOptions options) {
    options.board_aspect = true;
    return test::error_message([&] { calibrate(seen, options); });
  };
  EXPECT_EQ(fault({.warp = BoardWarp::free}),
            "--warp: is not estimated beside --board-shape, --motion or --board-aspect; leave it "
            "out; --board-shape contains it");
  EXPECT_EQ(fault({.pixel_sigma_px = 0.1}),
            "--pixel-sigma: is estimated with --board-shape, --motion and --board-aspect; leave it "
            "out");
}

// With a bend in few views both are found.
TEST(BoardAspect, IsFoundBesideABend) {
  const SimulatedBoard board = turned_board(12);
  const auto points =
      warped_target(stretched_target(board.observations.target_m, 2 * stretch), {1e-3, 1e-3});
  const BoardObservations seen = test::of_points(board, points);
  CalibrationOptions options;
  EffectsTest test;
  const RigEstimate found = with_found_effects(calibrate(seen), seen, options, test);
  EXPECT_TRUE(options.board_aspect && options.board_shape);
  const AspectEstimate& aspect = *found.calibration->board_aspect;
  EXPECT_NEAR(aspect.value, 2 * stretch, 4 * aspect.sigma);
  EXPECT_LT(squared_distance(found), 45);
}

}  // namespace
}  // namespace vernier
