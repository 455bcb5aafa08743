// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// The limits were chosen on real sets and on the simulated sets 1001 to 1006 of
// bench/wrong_calibrations.cpp; the seeds here are others.
#include "calib/calibration/change_findings.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <random>
#include <string>

#include "calib/board_observations.h"
#include "calib/board_target.h"
#include "calib/calibrate.h"
#include "calib/calibration/frame_scatter.h"
#include "calib/rig_estimate.h"
#include "calib/simulated_board.h"
#include "tests/support/bent_board.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

SimulatedBoard drawn_board(std::uint64_t seed, int frames = 16) {
  return simulate_board(test::stereo_rig(), Chessboard{9, 6, 0.03},
                        {.seed = seed, .frames = frames});
}

/// Moves every corner of the right images by the frame's shift.
BoardObservations shifted(BoardObservations o, const std::function<Eigen::Vector2d(int)>& by) {
  for (BoardView& view : o.views) {
    if (view.camera != 1) continue;
    for (Eigen::Vector2d& p : view.pixels_px) p += by(view.frame);
  }
  return o;
}

BoardObservations jittered(BoardObservations o, double most_px, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> draw(-most_px, most_px);
  for (BoardView& view : o.views) {
    if (view.camera != 1) continue;
    const Eigen::Vector2d by{draw(random), draw(random)};
    for (Eigen::Vector2d& p : view.pixels_px) p += by;
  }
  return o;
}

std::vector<std::string> doubts_of(const BoardObservations& o) {
  return calibrate(o).calibration->trust_warnings;
}

BoardState state_of(const RigEstimate& e) {
  return {e.rig, e.evidence->frames, e.evidence->T_first_board, e.evidence->warp_m};
}

bool tells_time(const std::string& doubt) {
  return doubt.find("not simultaneous") != std::string::npos ||
         doubt.find("did not see the board at the same pose") != std::string::npos;
}

TEST(ChangeFindings, ImagesThatAreOffFromFrameToFrameAreNotSimultaneous) {
  for (const double px : {2.0, 4.0}) {
    const auto doubts = doubts_of(jittered(drawn_board(3).observations, px, 1));
    ASSERT_EQ(doubts.size(), 1u) << px;
    EXPECT_TRUE(tells_time(doubts[0])) << doubts[0];
  }
}

TEST(ChangeFindings, OneChangeIsNamedWithItsFrame) {
  const auto after_9 = [](int frame) { return Eigen::Vector2d(0, frame > 9 ? 2 : 0); };
  const auto doubts = doubts_of(shifted(drawn_board(4).observations, after_9));
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_EQ(doubts[0].find("the rig changed after frame 9: another"), 0u) << doubts[0];
}

TEST(ChangeFindings, AConstantShiftIsACropAndNoDoubt) {
  const auto always = [](int) { return Eigen::Vector2d(3, -2); };
  EXPECT_TRUE(doubts_of(shifted(drawn_board(5).observations, always)).empty());
}

TEST(ChangeFindings, ABentBoardIsNamed) {
  const auto doubts = doubts_of(test::bent(drawn_board(6), {6e-3, 2e-3}));
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_EQ(doubts[0].find("the board is not flat: a warp of 6"), 0u) << doubts[0];
}

TEST(ChangeFindings, FewFramesAreNotTested) {
  const SimulatedBoard board = drawn_board(7, 3);
  EXPECT_TRUE(frame_scatter(board.observations, board.truth).empty());
}

// Of white noise both shares are near zero, so no limit is near: 40 sets, none accused.
TEST(ChangeFindings, WhiteNoiseIsNotAccused) {
  double mean_f = 0, largest = 0;
  for (std::uint64_t seed = 100; seed < 140; ++seed) {
    const SimulatedBoard board = drawn_board(seed, 8 + static_cast<int>(seed % 7));
    const RigEstimate estimate = calibrate(board.observations);
    EXPECT_TRUE(estimate.calibration->trust_warnings.empty()) << seed;
    for (const FrameScatter& s :
         frame_scatter(estimate.evidence->observations, state_of(estimate))) {
      largest = std::max(largest, s.share);
      if (s.kept == Kept::pose && !s.is_split) mean_f += s.f_ratio / 40;
    }
  }
  EXPECT_LT(largest, 0.1);
  EXPECT_GT(mean_f, 0.6);  // the rig took 16 of the 6 n directions
  EXPECT_LT(mean_f, 1.1);
}

}  // namespace
}  // namespace vernier
