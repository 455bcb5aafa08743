// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/board_pose.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_target.h"
#include "calib/calibrate.h"
#include "calib/calibration/outliers.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/simulated_board.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

double apart(const Pose& a, const Pose& b) {
  return vector_from_rotation(a.R * b.R.transpose()).norm() + (a.t - b.t).norm();
}

BoardView seen_by(const Camera& camera,
                  const std::vector<Eigen::Vector3d>& target_m,
                  const Pose& T_camera_board) {
  BoardView view{0, 0, "", {}, {}};
  for (std::size_t i = 0; i < target_m.size(); ++i) {
    view.ids.push_back(static_cast<int>(i));
    view.pixels_px.push_back(project(camera, T_camera_board * target_m[i]));
  }
  return view;
}

class BoardPoses : public testing::Test {
 protected:
  std::mt19937_64 chance_{8};
  double draw(double low, double high) {
    return std::uniform_real_distribution(low, high)(chance_);
  }
  /// Tilted by up to 40 degrees about x and y, anywhere in the image.
  Pose tilted_board(double distance_m) {
    Pose pose;
    pose.R = rotation_from_vector({draw(-0.7, 0.7), draw(-0.7, 0.7), draw(-0.3, 0.3)});
    pose.t = {draw(-0.3, 0.2) * distance_m, draw(-0.25, 0.15) * distance_m, distance_m};
    return pose;
  }

  Rig one_{{test::stereo_rig().cameras[0]}, {Pose{}}};
  std::vector<Eigen::Vector3d> target_m_ = target_points(Chessboard{9, 6, 0.025});
};

TEST_F(BoardPoses, TheMirrorImageOfTheMirrorImageIsTheBoard) {
  for (int i = 0; i < 50; ++i) {
    const Pose pose = tilted_board(0.8);
    const BoardView view = seen_by(one_.cameras[0], target_m_, pose);
    const Pose other = mirrored_board_pose(target_m_, view, pose);
    EXPECT_NEAR(other.R.determinant(), 1, 1e-12);
    EXPECT_LT(apart(mirrored_board_pose(target_m_, view, other), pose), 1e-12);
  }
}

// The pixels of the two differ by the perspective within the board, which falls with the square of
// the distance.
TEST_F(BoardPoses, FarAwayTheMirrorImageLooksTheSame) {
  const auto largest_px = [&](double distance_m) {
    double largest = 0;
    for (int i = 0; i < 50; ++i) {
      const Pose pose = tilted_board(distance_m);
      const BoardView view = seen_by(one_.cameras[0], target_m_, pose);
      const BoardView other =
          seen_by(one_.cameras[0], target_m_, mirrored_board_pose(target_m_, view, pose));
      for (std::size_t k = 0; k < view.ids.size(); ++k) {
        largest = std::max(largest, (view.pixels_px[k] - other.pixels_px[k]).norm());
      }
    }
    return largest;
  };
  EXPECT_GT(largest_px(1), 1);
  EXPECT_LT(largest_px(20), 0.05);
}

TEST_F(BoardPoses, AFitFromTheMirrorImageFindsTheBoard) {
  int stuck = 0;
  for (int i = 0; i < 100; ++i) {
    const Pose pose = tilted_board(0.8);
    const BoardView view = seen_by(one_.cameras[0], target_m_, pose);
    const Pose start = mirrored_board_pose(target_m_, view, pose);
    stuck += fit_board_pose(target_m_, std::span(&view, 1), one_, start, 30).rms_px > 0.01;
    const BoardPoseFit fit = fit_board_pose_both_ways(target_m_, view, one_, start, 30);
    EXPECT_LT(fit.rms_px, 1e-6);
    EXPECT_LT(apart(fit.T_first_board, pose), 1e-6);
  }
  EXPECT_GT(stuck, 30);  // it is a local minimum
}

TEST_F(BoardPoses, AllViewsOfAFrameDecideTogether) {
  const Rig rig = test::stereo_rig();
  for (int i = 0; i < 50; ++i) {
    const Pose pose = tilted_board(1.5);
    std::vector<BoardView> views;
    for (int c = 0; c < 2; ++c) {
      views.push_back(seen_by(rig.cameras[c], target_m_, rig.T_camera_first[c] * pose));
      views.back().camera = c;
      for (auto& p : views.back().pixels_px) p += Eigen::Vector2d{draw(-0.5, 0.5), draw(-0.5, 0.5)};
    }
    const BoardPoseFit fit = find_board_pose(target_m_, views, rig);
    EXPECT_LT(fit.rms_px, 0.4);
    EXPECT_LT(vector_from_rotation(fit.T_first_board.R * pose.R.transpose()).norm(), 0.05);
  }
}

TEST_F(BoardPoses, CornersThatNoPoseFitsAreAnError) {
  BoardView view = seen_by(one_.cameras[0], target_m_, tilted_board(0.8));
  for (auto& p : view.pixels_px) p.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW(find_board_pose(target_m_, std::span(&view, 1), one_), Error);
}

// A board that least squares has left in the minimum beside its own is placed again; a view that
// is wrong stays an outlier.
TEST(OutlyingBoards, ArePlacedAgainWhereAPoseFits) {
  const SimulatedBoard made = simulate_board(test::stereo_rig(), {}, {.seed = 21, .frames = 12});
  BoardObservations seen = made.observations;
  const BoardState truth = made.truth;
  BoardState state = truth;
  EXPECT_FALSE(place_outlying_boards(seen, state));
  // the most tilted board
  double most = 0;
  std::size_t frame = 0;
  Pose mirrored;
  for (std::size_t f = 0; f < truth.frames.size(); ++f) {
    const BoardView& view = seen.views[2 * f];
    ASSERT_EQ(view.frame, state.frames[f]);
    const Pose other = mirrored_board_pose(seen.target_m, view, truth.T_first_board[f]);
    const double far = apart(other, truth.T_first_board[f]);
    if (far <= most) continue;
    most = far;
    frame = f;
    mirrored = other;
  }
  EXPECT_GT(most, 0.7);
  state.T_first_board[frame] = mirrored;
  EXPECT_TRUE(place_outlying_boards(seen, state));
  EXPECT_LT(apart(state.T_first_board[frame], truth.T_first_board[frame]), 0.02);
  // corners of another view
  seen.views[2 * 7].pixels_px = seen.views[2 * 8].pixels_px;
  BoardState wrong = truth;
  place_outlying_boards(seen, wrong);
  EXPECT_FALSE(outliers_at(seen, wrong).outliers.empty());
}

/// A pair with wide lenses, 2000 x 1500, and boards up to the border of the image, where distortion
/// bends a board as perspective does.
BoardObservations wide_views(std::uint64_t seed) {
  Rig rig;
  for (int c = 0; c < 2; ++c) {
    Camera camera;
    camera.model = OpenCv4{};
    camera.size_px = {2000, 1500};
    camera.parameters = Eigen::VectorXd::Zero(parameter_count(camera.model));
    camera.parameters << 800 + 6 * c, 1, 1005 - 30 * c, 735 + 20 * c, -0.27 + 0.01 * c, 0.09,
        5e-4 - 8e-4 * c, -4e-4 + 1e-3 * c;
    rig.cameras.push_back(camera);
  }
  rig.T_camera_first = {Pose{}, Pose{rotation_from_vector({0.01, -0.02, 0.005}),
                                     Eigen::Vector3d(-0.2, 0.001, 0.002)}};
  BoardObservations seen{
      {rig.cameras[0].size_px, rig.cameras[1].size_px}, target_points(Chessboard{9, 6, 0.04}), {}};
  std::mt19937_64 chance(seed);
  std::normal_distribution<double> noise_px(0, 0.2);
  const auto draw = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(chance);
  };
  const Eigen::Vector3d centre_m(0.16, 0.1, 0);
  for (int frame = 0; frame < 12;) {
    Pose pose;
    pose.R = rotation_from_vector({draw(-0.6, 0.6), draw(-0.6, 0.6), draw(-0.15, 0.15)});
    const double z = draw(0.4, 1.1);
    pose.t = Eigen::Vector3d{draw(-1.1, 1.1) * z, draw(-0.8, 0.8) * z, z} - pose.R * centre_m;
    std::vector<BoardView> views;
    bool inside = true;
    for (int c = 0; c < 2; ++c) {
      views.push_back(seen_by(rig.cameras[c], seen.target_m, rig.T_camera_first[c] * pose));
      views.back().camera = c;
      views.back().frame = frame;
      const Pose T = rig.T_camera_first[c] * pose;
      const Eigen::Vector3d sight = (T * centre_m).normalized();
      inside = inside && T.R.col(2).dot(sight) > 0.35;
      for (auto& p : views.back().pixels_px) {
        inside = inside && p.x() > 5 && p.y() > 5 && p.x() < 1994 && p.y() < 1494;
        p += Eigen::Vector2d{noise_px(chance), noise_px(chance)};
      }
    }
    if (!inside) continue;
    for (BoardView& view : views) seen.views.push_back(std::move(view));
    ++frame;
  }
  return seen;
}

// Poses from single images under a rough lens were left on the wrong side of the line of sight in a
// third of such sets, and whole good images left out as outliers.
TEST(WideLenses, KeepAllGoodImages) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    CalibrationOptions options;
    options.model = OpenCv4{};
    const RigEstimate estimate = calibrate(wide_views(seed), options);
    EXPECT_TRUE(estimate.calibration->trust_warnings.empty()) << seed;
    EXPECT_LT(estimate.calibration->outliers.size(), 5u) << seed;
    EXPECT_NEAR(estimate.calibration->rms_px, 0.2, 0.02) << seed;
    EXPECT_NEAR(estimate.rig.cameras[0].f_px(), 800, 3) << seed;
  }
}

}  // namespace
}  // namespace vernier
