// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/planning/frame_kinds.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

#include "calib/board_observations.h"
#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/estimate/rig_part.h"
#include "calib/planning/view_population.h"
#include "calib/planning/views_needed.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/simulated_board.h"
#include "calib/statistics/random.h"
#include "calib/uncertainty/target_quantity.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

SimulatedBoard views(int frames, const Rig& rig = test::stereo_rig()) {
  return simulate_board(rig, {}, {.seed = 11, .frames = frames, .pixel_sigma_px = 0.2});
}

/// Views of which the first `whole` of every `of` are seen by both cameras, the others by one.
BoardObservations partly_seen(const BoardObservations& all, int whole, int of) {
  BoardObservations some = all;
  std::erase_if(some.views, [&](const BoardView& view) {
    return view.frame % of >= whole && view.camera == view.frame % 2;
  });
  return some;
}

TEST(FrameKinds, FurtherViewsAreSeenByAsManyCamerasAsThoseSoFar) {
  const BoardObservations some = partly_seen(views(24).observations, 1, 4);
  const ViewKnowledge partial = knowledge_of(calibrate(some), 1, "rig.json");
  EXPECT_EQ(partial.taken, 24);
  EXPECT_EQ(partial.taken_by_all(), 6);
  ASSERT_EQ(partial.pools[0].following.size(), 3U);  // both, left alone, right alone
  // what one camera sees alone says nothing of the rig's turn: the sum of the shares that do counts
  const double target = 0.5 * sd_after(partial, "depth", 3, {24})[0].sd;
  const int alike = views_needed(partial, "depth", 3, target).views - 24,
            by_all = views_needed(*with_views_by_all(partial), "depth", 3, target).views - 24;
  EXPECT_GT(alike, 2.0 * by_all);
  EXPECT_LT(alike, 5.0 * by_all);
}

TEST(FrameKinds, AreTheSetsOfCamerasAndTheirSharesAreDrawnAsTheyScatter) {
  const SimulatedBoard all = views(20);
  const auto kinds = frame_kinds(partly_seen(all.observations, 2, 5), all.truth.frames);
  ASSERT_EQ(kinds.size(), 3U);
  EXPECT_EQ(kinds[0].cameras, (std::vector<int>{0, 1}));
  EXPECT_EQ(kinds[0].frames.size(), 8U);
  EXPECT_EQ(kinds[1].frames.size() + kinds[2].frames.size(), 12U);
  double mean = 0, squares = 0;
  constexpr int draws = 4000;
  for (std::uint32_t i = 0; i < draws; ++i) {
    const std::vector<double> shares = drawn_shares(kinds, 3, i);
    EXPECT_NEAR(shares[0] + shares[1] + shares[2], 1, 1e-12);
    mean += shares[0] / draws;
    squares += shares[0] * shares[0] / draws;
  }
  // Dirichlet's: variance p (1 - p) / (n + 1); five standard errors
  const double sd = std::sqrt(0.4 * 0.6 / 21);
  EXPECT_NEAR(mean, 0.4, 5 * sd / std::sqrt(draws));
  EXPECT_NEAR(std::sqrt(squares - mean * mean), sd, 0.1 * sd);
}

TEST(FrameKinds, ViewsOfOneCameraAreInItsFrame) {
  const SimulatedBoard many = views(60);
  const Pose& T_right_left = many.truth.rig.T_camera_first[1];
  std::vector<Pose> T_right_board;
  for (const Pose& pose : many.truth.T_first_board) T_right_board.push_back(T_right_left * pose);
  const auto drawn =
      population_views(many.truth.rig, many.observations.target_m, {0, 0},
                       pose_population(T_right_board, many.observations.target_m), {1}, 30, 1, 0);
  ASSERT_EQ(drawn.size(), 30U);
  // of the left camera, and of the pose between both, it says nothing
  const double most = drawn[0].diagonal().maxCoeff();
  const int own = intrinsics_index(many.truth.rig, 1), pose = pose_index(many.truth.rig, 1);
  EXPECT_GT(drawn[0](own, own), 0);
  for (int p = 0; p < drawn[0].rows(); ++p) {
    if (p >= own && p < pose) continue;
    EXPECT_NEAR(drawn[0](p, p), 0, 1e-9 * most) << p;
  }
}

// The pair of a rig of three cameras: now, what the covariance of its part says, and the third
// camera's views count.
TEST(FrameKinds, APairOfThreeCamerasIsPlannedByTheViewsOfAll) {
  Rig rig = test::stereo_rig();
  rig.cameras.push_back(rig.cameras[0]);
  rig.cameras[2].name = "middle";
  rig.T_camera_first.push_back({rotation_from_vector({0.01, 0.02, -0.01}), {-0.05, 0.01, 0}});
  const RigEstimate now = calibrate(views(8, rig).observations);
  ViewKnowledge known = knowledge_of(now, 1, "rig.json");
  known.noise_log_sd = 0;
  for (const std::vector<int>& pair : {std::vector<int>{0, 2}, {2, 1}, {1, 0}}) {
    const ViewKnowledge of_pair = for_cameras(known, pair);
    const RigEstimate part = part_of(now, pair);
    const TargetQuantity depth = target_quantity(part.rig, "depth", 3);
    const Eigen::MatrixXd C =
        *part.covariance_mvb * std::pow(known.noise_px / now.calibration->pixel_sigma_px, 2);
    const double expected = std::sqrt((depth.gradient * C * depth.gradient.transpose())(0, 0));
    EXPECT_NEAR(sd_after(of_pair, "depth", 3, {8})[0].sd, expected, 1e-6 * expected);
    // the same by the whole rig's parameters
    const TargetQuantity of_rig = target_quantity(now.rig, pair, "depth", 3);
    EXPECT_NEAR(sd_of(of_rig, ScaledDecomposition({CovarianceKind::mvb, parameter_names(now.rig),
                                                   *now.covariance_mvb})
                                  .factor()),
                sd_of(depth, ScaledDecomposition({CovarianceKind::mvb, parameter_names(part.rig),
                                                  *part.covariance_mvb})
                                 .factor()),
                1e-6 * expected);
    EXPECT_LT(sd_after(of_pair, "depth", 3, {32})[0].sd, 0.7 * expected);
  }
}

/// The view of a board that is moved along the camera's x axis until less than half of it is seen.
BoardView cut_view(const SimulatedBoard& board, const BoardView& whole) {
  const auto c = static_cast<std::size_t>(whole.camera);
  const Rig& rig = board.truth.rig;
  RandomStream draws({.seed = 12, .trial = static_cast<std::uint32_t>(whole.frame)});
  for (double move_m = 0;; move_m += 0.02) {
    BoardView cut{whole.frame, whole.camera, {}, {}};
    for (const int id : whole.ids) {
      const auto& X = board.observations.target_m[static_cast<std::size_t>(id)];
      Eigen::Vector3d x = rig.T_camera_first[c] *
                          (board.truth.T_first_board[static_cast<std::size_t>(whole.frame)] * X);
      x.x() += move_m;
      const Eigen::Vector2d noise{draws.normal(), draws.normal()};
      const Eigen::Vector2d pixel = project(rig.cameras[c], x) + 0.2 * noise;
      if (!in_image(rig.cameras[c], pixel)) continue;
      cut.ids.push_back(id);
      cut.pixels_px.push_back(pixel);
    }
    if (2 * cut.ids.size() < whole.ids.size()) return cut;
  }
}

// Frames that cut the board are no reason not to plan, and say what they say.
TEST(FrameKinds, CutBoardsAreDrawnAgain) {
  const SimulatedBoard all = views(24);
  BoardObservations some = partly_seen(all.observations, 3, 4);
  const ViewKnowledge whole = knowledge_of(calibrate(some), 1, "rig.json");
  for (BoardView& view : some.views) {
    if (view.frame % 4 == 3) view = cut_view(all, view);
  }
  const ViewKnowledge known = knowledge_of(calibrate(some), 1, "rig.json");
  ASSERT_EQ(known.pools[0].following.size(), 2U);
  EXPECT_TRUE(known.pools[0].following[0].drawn);
  EXPECT_FALSE(known.pools[0].following[1].drawn);
  EXPECT_EQ(known.pools[0].following[1].views.size(), 6U);
  const double target = 0.5 * sd_after(known, "depth", 3, {24})[0].sd;
  const int cut = views_needed(known, "depth", 3, target).views;
  EXPECT_NEAR(cut, views_needed(whole, "depth", 3, target).views, 0.2 * cut);
}

// Two frames that both cameras see are taken to be held as those of one: they are not repeated,
// which would show no new tilt.
TEST(FrameKinds, FewFramesAreHeldAsTheOthersAre) {
  BoardObservations some = views(24).observations;
  std::erase_if(some.views, [](const BoardView& view) {
    return view.frame >= 2 && view.camera == view.frame % 2;
  });
  const ViewKnowledge known = knowledge_of(calibrate(some), 1, "rig.json");
  EXPECT_EQ(known.taken_by_all(), 2);
  ASSERT_TRUE(known.pools[0].following[0].drawn);
  EXPECT_GT(known.pools[0].following[0].views.size(), 2U);
  const double target = 0.4 * sd_after(known, "depth", 3, {24})[0].sd;
  const ViewsNeeded alike = views_needed(known, "depth", 3, target),
                    by_all = views_needed(*with_views_by_all(known), "depth", 3, target);
  EXPECT_LT(by_all.views, alike.views);
  EXPECT_LT(by_all.views, 24 + 60);
}

TEST(FrameKinds, ByAllMeansByAllThatWereChosen) {
  Rig rig = test::stereo_rig();
  rig.cameras.push_back(rig.cameras[0]);
  rig.cameras[2].name = "middle";
  rig.T_camera_first.push_back({rotation_from_vector({0.01, 0.02, -0.01}), {-0.05, 0.01, 0}});
  BoardObservations some = views(16, rig).observations;
  std::erase_if(some.views,
                [](const BoardView& view) { return view.camera == 2 && view.frame % 4; });
  const ViewKnowledge known = knowledge_of(calibrate(some), 1, "rig.json");
  EXPECT_EQ(known.taken_by_all(), 4);
  EXPECT_EQ(for_cameras(known, {0, 1}).taken_by_all(), 16);
  EXPECT_EQ(for_cameras(known, {2, 1}).taken_by_all(), 4);
  const auto better = with_views_by_all(for_cameras(known, {0, 1}));
  double shares = 0;
  for (const PlannedViews& kind : better->pools[0].following) shares += kind.share;
  EXPECT_NEAR(shares, 1, 1e-12);
}

}  // namespace

}  // namespace vernier
