// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/resolve.h"
#include "calib/base/decompositions.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/estimate/held_parameters.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "calib/simulated_board.h"
#include "calib/solver/initial_rig.h"
#include "calib/solver/reprojection_problem.h"
#include "tests/support/resolver_oracle.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

using namespace test;

Rig three_cameras() {
  Rig rig = test::stereo_rig(OpenCv4{});
  rig.cameras[1] = test::stereo_rig(Radial1{}).cameras[1];
  rig.cameras.push_back(test::stereo_rig(Fisheye4{}).cameras[0]);
  rig.cameras[2].name = "third";
  rig.T_camera_first.push_back({rotation_from_vector({0.02, 0.03, -0.01}), {0.15, 0.01, 0}});
  return rig;
}

TEST(Resolver, OneCamera) {
  Rig rig = test::stereo_rig(OpenCv5{});
  rig.cameras.pop_back();
  rig.T_camera_first.pop_back();
  const SimulatedBoard board = scene(rig, 13);
  expect_as_ceres(board.observations, perturbed(board, 3));
}

TEST(Resolver, ThreeCamerasOfDifferentModels) {
  const SimulatedBoard board = scene(three_cameras(), 21);
  expect_as_ceres(board.observations, perturbed(board, 3));
}

TEST(Resolver, FramesThatSomeCamerasMissed) {
  SimulatedBoard board = scene(three_cameras(), 40);
  std::erase_if(board.observations.views, [](const BoardView& view) {
    return (view.frame % 3 == 1 && view.camera == view.frame % 2) ||
           (view.frame > 30 && view.frame % 3 != 1 && view.camera > 0);
  });
  make_partial(board.observations);
  expect_as_ceres(board.observations, board.truth);
}

TEST(Resolver, OtherPixelsAreAnotherCalibration) {
  const Rig rig = test::stereo_rig(OpenCv4{});
  const SimulatedBoard board = scene(rig);
  const auto other = simulate_board(
      rig, {9, 7, 0.03},
      {.seed = 7, .trial = 5, .frames = 24, .pixel_sigma_px = 0.2, .distance_m = 0.9});
  Eigen::Matrix2Xd pixels(2, 24 * 2 * 63);
  Eigen::Index i = 0;
  for (const BoardView& view : other.observations.views) {
    for (const auto& q : view.pixels_px) pixels.col(i++) = q;
  }
  const ResolveResult ours = Resolver(board.observations, board.truth).resolve(pixels);
  EXPECT_EQ(ours.status, ResolveStatus::converged);
  EXPECT_LE(ours.iterations, 6);
  EXPECT_EQ(parameters(ours.state.rig),
            parameters(Resolver(other.observations, other.truth).resolve().state.rig));
  EXPECT_GT(
      difference(ours.state.rig, Resolver(board.observations, board.truth).resolve().state.rig)
          .norm(),
      1e-4);
}

TEST(Resolver, IsTheSameToTheBitForAnyThreads) {
  const SimulatedBoard board = scene(test::stereo_rig(Radial1{}), 300);
  const ResolveResult one = Resolver(board.observations, board.truth).resolve();
  const ResolveResult four =
      Resolver(board.observations, board.truth, {}, {.threads = 4}).resolve();
  EXPECT_EQ(parameters(one.state.rig), parameters(four.state.rig));
  EXPECT_EQ(one.chi2, four.chi2);
  for (std::size_t f = 0; f < 300; ++f) {
    EXPECT_EQ(one.state.T_first_board[f].t, four.state.T_first_board[f].t);
  }
}

TEST(Resolver, KnownWarpIsKept) {
  SimulatedBoard board = bent(scene(test::stereo_rig()), {2e-3, -1e-3});
  const double flat = Resolver(board.observations, board.truth).resolve().chi2;
  board.truth.warp_m = {2e-3, -1e-3};
  const ResolveResult known = Resolver(board.observations, board.truth).resolve();
  EXPECT_EQ(known.status, ResolveStatus::converged);
  EXPECT_EQ(known.state.warp_m, board.truth.warp_m);
  EXPECT_LT(known.chi2, 0.7 * flat);
  expect_as_ceres(board.observations, board.truth);
}

TEST(Resolver, HeldParametersStay) {
  const SimulatedBoard board = scene(test::stereo_rig(OpenCv5{}));
  const ReprojectionProblem problem{
      .held = held_mask(board.truth.rig, {{"left.ax"}, {"right.ax"}, {"right.wy_rad"}})};
  BoardState start = perturbed(board, 2);
  expect_as_ceres(board.observations, start, problem);
  const ResolveResult held = Resolver(board.observations, start, problem).resolve();
  ASSERT_EQ(held.status, ResolveStatus::converged);
  EXPECT_EQ(held.state.rig.cameras[0].ax(), start.rig.cameras[0].ax());
  EXPECT_EQ(held.state.rig.cameras[1].ax(), start.rig.cameras[1].ax());
  EXPECT_NEAR(vector_from_rotation(held.state.rig.T_camera_first[1].R)[1],
              vector_from_rotation(start.rig.T_camera_first[1].R)[1], 1e-15);
}

// Stated noise far below what residuals can show: lengths of steps are in its units.
TEST(Resolver, ATinyPixelSigmaIsTakenAtItsWord) {
  const SimulatedBoard board = scene(test::stereo_rig(), 24, 0);
  const ReprojectionProblem problem{.pixel_sigma_px = 1e-4};
  const BoardState start = perturbed(board, 1e-4);
  const ResolveResult once =
      Resolver(board.observations, start, problem, {.tolerance_sigma = 1e9}).resolve();
  ASSERT_EQ(once.iterations, 1);
  const Eigen::MatrixXd C = Resolver(board.observations, start, problem).covariance(start);
  const Eigen::VectorXd step = difference(once.state.rig, start.rig);
  const double length = std::sqrt(step.dot(solve_symmetric(C, step)));
  EXPECT_NEAR(once.error_left_sigma / length, 0.03 / 0.97, 1e-4);  // the rate that is counted on
}

TEST(Resolver, PriorsAreInTheCost) {
  const SimulatedBoard board = scene(test::stereo_rig());
  const int n = parameter_count(board.truth.rig);
  const Eigen::VectorXd sd = sigma_px * Reference(board.observations, board.truth).sd;
  RigPrior prior{retract(board.truth.rig, 3 * sd), Eigen::MatrixXd::Zero(n, n)};
  prior.mean.T_camera_first[1].R =
      rotation_from_vector({0.02, 0, 0.01}) * prior.mean.T_camera_first[1].R;
  prior.information.diagonal() = sd.cwiseAbs2().cwiseInverse();
  expect_as_ceres(board.observations, board.truth, {.pixel_sigma_px = sigma_px, .priors = {prior}});
}

TEST(Resolver, WeightsAreInTheCost) {
  const SimulatedBoard board = scene(test::stereo_rig());
  ReprojectionProblem problem;
  for (const BoardView& view : board.observations.views) {
    auto& weights = problem.corner_weights.emplace_back();
    for (const int id : view.ids) weights.push_back((id + view.frame) % 4 / 3.0);
  }
  expect_as_ceres(board.observations, board.truth, problem);
}

TEST(Resolver, ExactCornersGiveTheTruth) {
  SimulatedBoard board = scene(test::stereo_rig(OpenCv4{}), 24, 0);
  const BoardState truth = board.truth;
  const ResolveResult result =
      Resolver(board.observations, initial_state(board.observations, {OpenCv4{}, OpenCv4{}}))
          .resolve();
  EXPECT_EQ(result.status, ResolveStatus::converged);
  EXPECT_LT(difference(result.state.rig, truth.rig).norm(), 1e-7);
  EXPECT_LT(result.chi2, 1e-15);
}

TEST(Resolver, SaysWhenADirectionIsFree) {
  // One frame, parallel to the image: focal length and distance cannot be told apart.
  SimulatedBoard board = scene(test::stereo_rig(Pinhole{}), 1, 0);
  board.observations.views.pop_back();
  board.observations.size_px.pop_back();
  board.truth.rig.cameras.pop_back();
  board.truth.rig.T_camera_first.pop_back();
  board.truth.T_first_board[0] = {Eigen::Matrix3d::Identity(), {-0.1, -0.06, 1}};
  for (std::size_t i = 0; i < board.observations.target_m.size(); ++i) {
    board.observations.views[0].pixels_px[i] =
        project(board.truth.rig.cameras[0],
                board.truth.T_first_board[0] * board.observations.target_m[i]) +
        Eigen::Vector2d(0.1 * std::sin(5.0 * static_cast<double>(i)), 0);
  }
  EXPECT_EQ(Resolver(board.observations, board.truth).resolve().status, ResolveStatus::singular);
  // A frame whose corners lie on a line does not fix its board.
  SimulatedBoard line = scene(test::stereo_rig(), 20);
  for (BoardView& view : line.observations.views) {
    if (view.frame != 3) continue;
    view.ids.resize(9);  // one row of corners
    view.pixels_px.resize(9);
  }
  const ResolveResult result = Resolver(line.observations, line.truth).resolve();
  EXPECT_EQ(result.status, ResolveStatus::singular);
  EXPECT_TRUE(parameters(result.state.rig).allFinite());
}

TEST(Resolver, NamesWhatIsWrong) {
  const SimulatedBoard board = scene(test::stereo_rig(), 8);
  const auto message = [](const auto& f) {
    try {
      f();
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("nothing thrown");
  };
  const Resolver resolver(board.observations, board.truth);
  Eigen::Matrix2Xd pixels = Eigen::Matrix2Xd::Zero(2, 8 * 2 * 63);
  pixels(1, 77) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message([&] { resolver.resolve(pixels); }),
            "corner 77: its pixel is not finite; leave the corner out");
  EXPECT_EQ(message([&] { resolver.resolve(Eigen::Matrix2Xd::Zero(2, 5)); }),
            "pixels: there are 5 for 1008 corners; give one per corner, in the order of the "
            "observations");
  BoardState other = board.truth;
  other.frames[3] = 99;
  EXPECT_NE(message([&] { Resolver(board.observations, other); }).find("frame 3: the state has no"),
            std::string::npos);
  const auto fault = [&](const ReprojectionProblem& problem) {
    return message([&] { Resolver(board.observations, board.truth, problem); });
  };
  EXPECT_EQ(fault({.held = {true}}),
            "held parameters: there is not one flag per rig parameter; make them with "
            "held_mask");
  EXPECT_EQ(fault({.priors = {{board.truth.rig, Eigen::MatrixXd::Identity(3, 3)}}}),
            "prior: it does not match the rig's parameters; make it with rig_prior");
  EXPECT_EQ(fault({.corner_weights = {{1.0}}}),
            "corner weights: there is not one per corner; give one per corner");
  EXPECT_EQ(fault({.pixel_sigma_px = 0}),
            "pixel sigma: it is not positive; give a standard deviation in pixels");
}

}  // namespace
}  // namespace vernier
