// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <limits>
#include <memory>

#include "calib/base/decompositions.h"
#include "calib/board/board_warp.h"
#include "calib/board/view_linearisation.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/calibration/minimum_variance_bound.h"
#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/estimate/held_parameters.h"
#include "calib/estimate/rig_part.h"
#include "calib/pose.h"
#include "calib/projection_uncertainty.h"
#include "calib/rig.h"
#include "calib/rig_and_boards.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"
#include "calib/sampler.h"
#include "calib/simulated_board.h"
#include "calib/solver/minimise_reprojection.h"
#include "calib/solver/normal_equations.h"
#include "calib/solver/reprojection_problem.h"
#include "calib/triangulation.h"
#include "calib/triangulation_uncertainty.h"
#include "calib/uncertainty/joint_information.h"
#include "calib/uncertainty/pose_covariance.h"
#include "calib/uncertainty/sampled_propagation.h"
#include "tests/support/numeric_jacobian.h"
#include "tests/support/relative_difference.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

constexpr double far_away_m = std::numeric_limits<double>::infinity();
const std::vector<Eigen::Vector2d> pixels{{320, 240}, {40, 30}, {600, 35}, {25, 450}, {610, 440}};

bool has_part(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

template <typename Call>
std::string error_output(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

/// A calibration from ten noisy views with the noise known to be white.
const RigEstimate& nominal_estimate() {
  static const RigEstimate estimate = [] {
    const SimulatedBoard board = simulate_board(test::stereo_rig(), {6, 5, 0.05},
                                                {.seed = 7, .frames = 10, .pixel_sigma_px = 0.2});
    return calibrate(board.observations, {.pixel_sigma_px = 0.2, .white_noise = true});
  }();
  return estimate;
}

// The whole chain against brute force: every pixel of a noise-free calibration is moved by ±h, all
// is solved again, and a point fixed to the boards is carried through the answer and projected.
class BruteForce : public testing::Test {
 protected:
  static constexpr double h_px = 0.02;

  void SetUp() override {
    const SimulatedBoard board = simulate_board(test::stereo_rig(), {4, 3, 0.1},
                                                {.seed = 5, .frames = 6, .pixel_sigma_px = 0});
    observations_ = board.observations;
    truth_ = board.truth;
  }

  /// The bound at the truth with everything free.
  void estimate_all() {
    estimate_.rig = truth_.rig;
    const auto equations = reduced_normal_equations(observations_, truth_, 1.0);
    const auto names = parameter_names(truth_.rig);
    estimate_.covariance =
        Covariance{CovarianceKind::mvb, names, minimum_variance_bound(equations, names)};
    estimate_.calibration.emplace().pixel_sigma_px = 1;
    estimate_.evidence = CalibrationEvidence{observations_, truth_.frames, truth_.T_first_board};
  }

  /// Calls on_response(answer at +h, answer at −h) for every coordinate of every corner.
  template <typename OnResponse>
  void move_every_pixel(OnResponse on_response) {
    for (BoardView& view : observations_.views) {
      for (Eigen::Vector2d& pixel : view.pixels_px) {
        for (int axis = 0; axis < 2; ++axis) {
          const double kept = pixel[axis];
          pixel[axis] = kept + h_px;
          const BoardState plus = minimise_reprojection(observations_, truth_, problem_);
          pixel[axis] = kept - h_px;
          const BoardState minus = minimise_reprojection(observations_, truth_, problem_);
          pixel[axis] = kept;
          on_response(plus, minus);
        }
      }
    }
  }

  /// x_first carried by the mean of the boards.
  Eigen::Vector3d carried(const BoardState& state, const Eigen::Vector3d& x, bool at_infinity) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t f = 0; f < state.frames.size(); ++f) {
      const Pose moved = state.T_first_board[f] * truth_.T_first_board[f].inverse();
      sum += at_infinity ? Eigen::Vector3d(moved.R * x) : moved * x;
    }
    return sum / static_cast<double>(state.frames.size());
  }

  BoardObservations observations_;
  /// Compares the propagated covariances with the sums of squared responses.
  void compare();

  BoardState truth_;
  RigEstimate estimate_;
  ReprojectionProblem problem_;
};

void BruteForce::compare() {
  const Eigen::Vector3d x(0.2, -0.1, 1.7);
  const auto project_in = [&](const BoardState& s, int c, bool at_infinity) -> Eigen::Vector2d {
    const Pose& T = s.rig.T_camera_first[c];
    const Eigen::Vector3d moved = carried(s, x, at_infinity);
    return project(s.rig.cameras[c], at_infinity ? Eigen::Vector3d(T.R * moved) : T * moved);
  };
  const PixelPair pair = *pixel_pair(truth_.rig, x);
  Eigen::Matrix2d C[2][2] = {{Eigen::Matrix2d::Zero(), Eigen::Matrix2d::Zero()},
                             {Eigen::Matrix2d::Zero(), Eigen::Matrix2d::Zero()}};
  Eigen::Matrix3d in_rig = Eigen::Matrix3d::Zero(), stabilised = Eigen::Matrix3d::Zero();
  move_every_pixel([&](const BoardState& plus, const BoardState& minus) {
    for (int c = 0; c < 2; ++c) {
      for (int far = 0; far < 2; ++far) {
        const Eigen::Vector2d d =
            (project_in(plus, c, far) - project_in(minus, c, far)) / (2 * h_px);
        C[c][far] += d * d.transpose();
      }
    }
    const Eigen::Vector3d d =
        (*triangulate_point(plus.rig, pair) - *triangulate_point(minus.rig, pair)) / (2 * h_px);
    const Eigen::Vector3d s = d - (carried(plus, x, false) - carried(minus, x, false)) / (2 * h_px);
    in_rig += d * d.transpose();
    stabilised += s * s.transpose();
  });
  const RigAndBoards joint = rig_and_boards(estimate_, CovarianceChoice::honest);
  for (int c = 0; c < 2; ++c) {
    const ProjectionUncertainty ours(joint, c, PointFixedTo::boards);
    const Pose& T = truth_.rig.T_camera_first[c];
    EXPECT_LT(test::relative_difference(ours.covariance_of_point(T * x), C[c][0]), 1e-5);
    EXPECT_LT(test::relative_difference(ours.covariance_of_direction(T.R * x), C[c][1]), 1e-5);
  }
  const auto told = [&](TriangulationFrame frame) {
    return TriangulationUncertainty(joint, frame).at(pair, 0)->calibration;
  };
  EXPECT_LT(test::relative_difference(told(TriangulationFrame::rig), in_rig), 1e-5);
  EXPECT_LT(test::relative_difference(told(TriangulationFrame::stabilised), stabilised), 1e-5);
}

TEST_F(BruteForce, ProjectionAndTriangulationRespondAsPropagated) {
  estimate_all();
  compare();
}

TEST_F(BruteForce, AlsoWithParametersHeldAndABoardThatIsNotFlat) {
  truth_.warp_m = {6e-4, -4e-4};
  const auto target = warped_target(observations_.target_m, truth_.warp_m);
  for (BoardView& view : observations_.views) {
    const Pose T = truth_.rig.T_camera_first[view.camera] * truth_.T_first_board[view.frame];
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      view.pixels_px[i] = project(truth_.rig.cameras[view.camera], T * target[view.ids[i]]);
    }
  }
  const std::vector<HeldParameter> held{{"left.ax", 1.002}, {"right.wy_rad", {}}};
  estimate_ = calibrate(observations_, {.pixel_sigma_px = 1,
                                        .held = {{"left.ax", 1.002}, {"right.wy_rad", -0.02}},
                                        .warp = BoardWarp::free,
                                        .reject_outliers = false,
                                        .white_noise = true});
  EXPECT_LT(difference(estimate_.rig, truth_.rig).cwiseAbs().maxCoeff(), 1e-3);
  problem_ = {.held = held_mask(truth_.rig, held), .warp = BoardWarp::free};
  compare();
}

/// Covariance at unit noise of (rig, board poses) from a dense numeric Jacobian of all residuals by
/// rig, poses and, where it is not flat, the board's warp.
Eigen::MatrixXd dense_covariance(const BoardObservations& observations, const BoardState& state) {
  const int n = parameter_count(state.rig);
  const auto frames = static_cast<int>(state.frames.size());
  const int warp = state.warp_m.isZero(0) ? 0 : 2;
  const auto residuals = [&](const Eigen::VectorXd& delta) {
    const Rig rig = retract(state.rig, delta.head(n));
    Eigen::Vector2d moved_warp = state.warp_m;
    if (warp) moved_warp += delta.tail<2>();
    const auto target = warped_target(observations.target_m, moved_warp);
    std::vector<double> r;
    for (const BoardView& view : observations.views) {
      const Pose T = retract(state.T_first_board[view.frame], delta.segment<6>(n + 6 * view.frame));
      ViewLinearisation J;
      linearise_view(rig.cameras[view.camera], rig.T_camera_first[view.camera], T, target, view,
                     Linearise::residual_only, J);
      r.insert(r.end(), J.residual_px.begin(), J.residual_px.end());
    }
    return Eigen::VectorXd(Eigen::Map<Eigen::VectorXd>(r.data(), static_cast<long>(r.size())));
  };
  const int all = n + 6 * frames + warp;
  const Eigen::MatrixXd J = test::numeric_jacobian(residuals, Eigen::VectorXd::Zero(all), 1e-5);
  const Eigen::VectorXd scale = J.colwise().norm().cwiseInverse();
  const Eigen::MatrixXd scaled = J * scale.asDiagonal();
  const Eigen::MatrixXd inverse = solve_symmetric(
      scaled.transpose() * scaled, Eigen::MatrixXd(Eigen::MatrixXd::Identity(all, all)));
  return (scale.asDiagonal() * inverse * scale.asDiagonal()).topLeftCorner(all - warp, all - warp);
}

TEST(JointInformation, IsTheInverseOfTheFullNormalMatrixForFlatAndWarpedBoards) {
  const SimulatedBoard board = simulate_board(test::stereo_rig(), {5, 4, 0.05},
                                              {.seed = 9, .frames = 7, .pixel_sigma_px = 0});
  for (const Eigen::Vector2d& warp_m : {Eigen::Vector2d(0, 0), Eigen::Vector2d(8e-4, -5e-4)}) {
    BoardState state = board.truth;
    state.warp_m = warp_m;
    const Eigen::MatrixXd full = dense_covariance(board.observations, state);
    const int n = parameter_count(state.rig);
    const RigAndBoards joint{state.rig,
                             state.frames,
                             state.T_first_board,
                             full.topLeftCorner(n, n),
                             std::make_shared<const ConditionalBoardPoses>(
                                 conditional_board_poses(board.observations, state)),
                             1.0};
    const Eigen::VectorXd sd = full.diagonal().cwiseSqrt();
    const Eigen::MatrixXd difference = sd.cwiseInverse().asDiagonal() *
                                       (rig_and_poses_covariance(joint) - full) *
                                       sd.cwiseInverse().asDiagonal();
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-6) << "warp " << warp_m.transpose();
  }
}

TEST(JointInformation, MeanMotionIsTheMeanOfThePoses) {
  const RigAndBoards joint = rig_and_boards(nominal_estimate(), CovarianceChoice::mvb);
  const int n = parameter_count(joint.rig), frames = static_cast<int>(joint.frames.size());
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n + 6, n + 6 * frames);
  M.topLeftCorner(n, n).setIdentity();
  for (int f = 0; f < frames; ++f) {
    M.block<3, 3>(n, n + 6 * f).setIdentity();
    M.block<3, 3>(n + 3, n + 6 * f) = hat(joint.T_first_board[f].t);
    M.block<3, 3>(n + 3, n + 6 * f + 3).setIdentity();
  }
  M.bottomRows(6) /= frames;
  EXPECT_LT(test::relative_difference(rig_and_motion_covariance(joint),
                                      M * rig_and_poses_covariance(joint) * M.transpose()),
            1e-10);
}

TEST(ProjectionUncertainty, DoesNotDependOnWhichCameraIsTheFirst) {
  BoardObservations swapped = nominal_estimate().evidence->observations;
  for (BoardView& view : swapped.views) view.camera = 1 - view.camera;
  const RigEstimate other = calibrate(swapped, {.pixel_sigma_px = 0.2, .white_noise = true});
  const RigAndBoards joint = rig_and_boards(nominal_estimate(), CovarianceChoice::mvb);
  const RigAndBoards joint_swapped = rig_and_boards(other, CovarianceChoice::mvb);
  for (int c = 0; c < 2; ++c) {
    const ProjectionUncertainty a(joint, c, PointFixedTo::boards);
    const ProjectionUncertainty b(joint_swapped, 1 - c, PointFixedTo::boards);
    for (const double distance_m : {0.7, 5.0, far_away_m}) {
      for (const auto& q : pixels) {
        EXPECT_LT(
            test::relative_difference(*a.covariance(q, distance_m), *b.covariance(q, distance_m)),
            1e-5);
      }
    }
  }
}

TEST(ProjectionUncertainty, FarPointsApproachInfinityAndACameraFixedRayHasNoDistance) {
  const RigAndBoards joint = rig_and_boards(nominal_estimate(), CovarianceChoice::mvb);
  for (int c = 0; c < 2; ++c) {
    for (const auto fixed_to : {PointFixedTo::boards, PointFixedTo::first_camera}) {
      const ProjectionUncertainty u(joint, c, fixed_to);
      for (const auto& q : pixels) {
        EXPECT_LT(test::relative_difference(*u.covariance(q, 1e7), *u.covariance(q, far_away_m)),
                  1e-5);
      }
    }
    const ProjectionUncertainty camera(joint, c, PointFixedTo::camera);
    for (const auto& q : pixels) {
      EXPECT_LT(
          test::relative_difference(*camera.covariance(q, 0.3), *camera.covariance(q, far_away_m)),
          1e-12);
    }
  }
}

TEST(ProjectionUncertainty, ARigAloneGivesTheSameAsWithItsBoardsWhereTheyPlayNoPart) {
  const RigAndBoards joint = rig_and_boards(nominal_estimate(), CovarianceChoice::honest);
  const ProjectionUncertainty with(joint, 1, PointFixedTo::first_camera);
  const ProjectionUncertainty alone(joint.rig, joint.rig_covariance, 1, PointFixedTo::first_camera);
  EXPECT_EQ(*with.covariance({100, 90}, 2), *alone.covariance({100, 90}, 2));
}

TEST(ProjectionUncertainty, AnHonestCovarianceThatIsAMultipleOfTheBoundScalesEverything) {
  RigEstimate scaled = nominal_estimate();
  scaled.covariance->kind = CovarianceKind::jackknife;
  scaled.covariance->matrix = 4 * *scaled.covariance_mvb;
  const RigAndBoards honest = rig_and_boards(scaled, CovarianceChoice::honest);
  const RigAndBoards bound = rig_and_boards(scaled, CovarianceChoice::mvb);
  EXPECT_LT(test::relative_difference(rig_and_motion_covariance(honest),
                                      4 * rig_and_motion_covariance(bound)),
            1e-9);
}

// What a prior knows is no part of what the views' scatter inflates: with S the views' information
// and P the prior's, an honest covariance C S C + C P C with the first part nine times as large
// says that the views are three times as noisy.
TEST(ProjectionUncertainty, APriorIsNotInflatedWithTheViews) {
  const SimulatedBoard board = simulate_board(test::stereo_rig(), {6, 5, 0.05},
                                              {.seed = 7, .frames = 10, .pixel_sigma_px = 0.2});
  std::vector<ParameterPrior> known;
  const Eigen::VectorXd values = parameters(test::stereo_rig());
  const std::vector<std::string> names = parameter_names(test::stereo_rig());
  for (std::size_t i = 0; i < 13; ++i) {
    known.push_back({names[i], values[static_cast<Eigen::Index>(i)], i % 5 == 1 ? 1e-7 : 1e-5});
  }
  RigEstimate e =
      calibrate(board.observations, {.pixel_sigma_px = 0.2, .known = known, .white_noise = true});
  const CalibrationEvidence& evidence = *e.evidence;
  const Eigen::MatrixXd C = *e.covariance_mvb;
  const Eigen::MatrixXd S =
      reduced_normal_equations(evidence.observations,
                               {e.rig, evidence.frames, evidence.T_first_board}, 0.2)
          .information;
  ASSERT_LT((C * S).trace(), 4);  // of 16 parameters the views determine so many
  e.covariance->kind = CovarianceKind::jackknife;
  e.covariance->matrix = 9 * C * S * C + (C - C * S * C);
  EXPECT_NEAR(rig_and_boards(e, CovarianceChoice::honest).board_sigma_px, 3 * 0.2, 1e-5);
}

TEST(ProjectionUncertainty, HeldParametersTakeNoPart) {
  RigEstimate held = nominal_estimate();
  held.covariance->kind = CovarianceKind::jackknife;
  for (Eigen::MatrixXd* C : {&held.covariance->matrix, &*held.covariance_mvb}) {
    C->row(1).setZero();
    C->col(1).setZero();
  }
  const RigAndBoards joint = rig_and_boards(held, CovarianceChoice::honest);
  EXPECT_NEAR(joint.board_sigma_px, 0.2, 1e-9);
  EXPECT_TRUE(rig_and_motion_covariance(joint).row(1).isZero(0));
}

TEST(ProjectionUncertainty, PixelsWithoutARayAreAbsentAndCounted) {
  Rig rig = test::stereo_rig();
  rig.cameras[0].parameters[4] = -0.9;  // folds the image well inside its corners
  const Eigen::MatrixXd C = Eigen::MatrixXd::Identity(16, 16);
  const ProjectionUncertainty u(rig, C, 0, PointFixedTo::camera);
  EXPECT_FALSE(u.covariance({0, 0}, 1));
  const ProjectionGrid grid = projection_grid(u, {.columns = 9, .rows = 7});
  int nans = 0;
  for (const auto& c : grid.covariance) nans += c.hasNaN();
  EXPECT_EQ(nans, grid.absent);
  EXPECT_GT(grid.absent, 0);
  EXPECT_FALSE(grid.covariance[3 * 9 + 4].hasNaN());  // the middle
}

TEST(ProjectionUncertainty, GridIsThatOfTheImageRowByRow) {
  const ProjectionUncertainty u(nominal_estimate().rig, nominal_estimate().covariance->matrix, 0,
                                PointFixedTo::camera);
  const ProjectionGrid grid = projection_grid(u, {.columns = 5, .rows = 4});
  EXPECT_EQ(grid.x_px.back(), 639);
  EXPECT_EQ(grid.y_px.back(), 479);
  EXPECT_EQ(grid.covariance[1 * 5 + 3], *u.covariance({grid.x_px[3], grid.y_px[1]}, 1));
  EXPECT_NEAR(worst_sd(grid.covariance[0]), std::sqrt(symmetric_eigenvalues(grid.covariance[0])[1]),
              1e-12);
}

TEST(ProjectionUncertainty, BadInputIsNamed) {
  const Rig& rig = nominal_estimate().rig;
  const Eigen::MatrixXd& C = nominal_estimate().covariance->matrix;
  const ProjectionUncertainty u(rig, C, 0, PointFixedTo::camera);
  EXPECT_PRED2(has_part, error_output([&] { u.covariance({1, 1}, 0); }), "a distance of 0 m");
  EXPECT_PRED2(has_part, error_output([&] {
                 u.covariance({1, 1}, std::nan(""));
               }),
               "distance of nan");
  EXPECT_PRED2(has_part, error_output([&] { projection_grid(u, {.columns = 0, .rows = 0}); }),
               "a grid of 0x0");
  EXPECT_PRED2(has_part, error_output([&] {
                 projection_grid(u, {.columns = 3, .rows = 3, .distance_m = -1});
               }),
               "a distance of -1 m");
  EXPECT_PRED2(has_part,
               error_output([&] { ProjectionUncertainty(rig, C, 2, PointFixedTo::camera); }),
               "no camera 2: it has 2");
  EXPECT_PRED2(has_part,
               error_output([&] { ProjectionUncertainty(rig, C, 0, PointFixedTo::boards); }),
               "needs their poses");
  EXPECT_PRED2(has_part, error_output([&] {
                 ProjectionUncertainty(rig, Eigen::MatrixXd::Identity(3, 3), 0,
                                       PointFixedTo::camera);
               }),
               "does not match the rig's parameters");
}

TEST(RigAndBoards, WhatIsMissingIsNamed) {
  const auto with = [&](auto change) {
    RigEstimate e = nominal_estimate();
    change(e);
    return error_output([&] { rig_and_boards(e, CovarianceChoice::mvb, "r.json"); });
  };
  EXPECT_PRED2(has_part, with([](RigEstimate& e) { e.evidence.reset(); }),
               "r.json: it holds no views of a board");
  EXPECT_PRED2(has_part, with([](RigEstimate& e) { e.calibration.reset(); }),
               "r.json: its pixel noise is unknown");
  EXPECT_PRED2(has_part, with([](RigEstimate& e) {
                 e.covariance_mvb.reset();
                 e.covariance->kind = CovarianceKind::clustered;
               }),
               "r.json: it has no minimum variance bound");
}

TEST(Triangulation, DerivativesAreThoseOfDifferences) {
  for (const char* model : {"pinhole", "radial1", "opencv4", "opencv5", "opencv8", "fisheye4"}) {
    const Rig rig = test::stereo_rig(camera_model(model));
    for (const Eigen::Vector3d& x :
         {Eigen::Vector3d(0.1, -0.2, 1), Eigen::Vector3d(-0.6, 0.5, 4)}) {
      PixelPair pair = *pixel_pair(rig, x);
      pair.other_px.y() += 0.4;  // rays that miss each other, as noisy ones do
      const PointTriangulation p = *triangulate_point_with_jacobian(rig, pair);
      EXPECT_LT((p.x_m - x).norm(), 0.05);
      EXPECT_EQ(p.x_m, *triangulate_point(rig, pair));
      const auto by_rig = test::numeric_jacobian(
          [&](const Eigen::VectorXd& d) { return *triangulate_point(retract(rig, d), pair); },
          Eigen::VectorXd::Zero(parameter_count(rig)), 1e-5);
      EXPECT_LT(test::relative_difference(p.by_rig, by_rig), 1e-7) << model;
      const auto by_pixels = test::numeric_jacobian(
          [&](const Eigen::VectorXd& d) {
            return *triangulate_point(rig,
                                      {pair.first_px + d.head<2>(), pair.other_px + d.tail<2>()});
          },
          Eigen::VectorXd::Zero(4), 1e-3);
      EXPECT_LT(test::relative_difference(p.by_pixels, by_pixels), 1e-7) << model;
    }
  }
}

TEST(Triangulation, RaysThatMeetGiveTheirPointAndRaysThatPartNone) {
  const Rig rig = test::stereo_rig();
  const Eigen::Vector3d x(0.3, 0.2, 2.5);
  PixelPair pair = *pixel_pair(rig, x);
  EXPECT_LT((*triangulate_point(rig, pair) - x).norm(), 1e-9);
  pair.other_px.x() += 60;  // beyond infinity
  EXPECT_FALSE(triangulate_point(rig, pair));
  EXPECT_FALSE(triangulate_point_with_jacobian(rig, pair));
  EXPECT_FALSE(pixel_pair(rig, -x));
}

TEST(Triangulation, OfARigOfOneCameraIsRefused) {
  Rig one = test::stereo_rig();
  one.cameras.pop_back();
  one.T_camera_first.pop_back();
  EXPECT_PRED2(has_part, error_output([&] {
                 triangulate_point(one, {{1, 1}, {1, 1}});
               }),
               "the rig has 1 camera(s)");
  EXPECT_PRED2(has_part, error_output([&] {
                 TriangulationUncertainty(nominal_estimate().rig,
                                          nominal_estimate().covariance->matrix)
                     .at({{1, 1}, {1, 1}}, -1);
               }),
               "pixel noise is negative or not a number");
}

TEST(TriangulationUncertainty, ALengthIsBetterKnownThanItsEnds) {
  const RigAndBoards joint = rig_and_boards(nominal_estimate(), CovarianceChoice::mvb);
  const TriangulationUncertainty u(joint, TriangulationFrame::rig);
  const PixelPair a = *pixel_pair(joint.rig, {0, 0, 3}), b = *pixel_pair(joint.rig, {0.1, 0, 3});
  const Eigen::Matrix3d between = *u.between(a, b);
  const Eigen::Matrix3d at_a = u.at(a, 0.2)->calibration, at_b = u.at(b, 0.2)->calibration;
  const Eigen::Matrix3d difference = at_a + at_b - between - between.transpose();
  EXPECT_LT(difference(0, 0), 0.1 * at_a(0, 0));
  EXPECT_LT(test::relative_difference(*u.between(a, a), at_a), 1e-9);
}

TEST(RigPair, KeepsThePartOfTheCovarianceThatIsItsOwn) {
  Rig three = test::stereo_rig();
  three.cameras.push_back(three.cameras[1]);
  three.cameras[2].name = "third";
  three.cameras[2].parameters[0] = 500;
  three.T_camera_first.push_back(
      {rotation_from_vector({0, 0.05, 0.01}), Eigen::Vector3d(0.15, 0, 0.01)});
  const int n = parameter_count(three);
  RigEstimate all;
  all.rig = three;
  Eigen::MatrixXd root(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) root(i, j) = 1e-3 * std::sin(1.0 + i * n + j);
  }
  all.covariance =
      Covariance{CovarianceKind::prior, parameter_names(three), root * root.transpose()};
  const RigEstimate pair = pair_of(all, 2);
  EXPECT_EQ(pair.covariance->names, parameter_names(pair.rig));
  EXPECT_EQ(pair.covariance->names[5], "third.f_px");
  const PixelPair q = *pixel_pair(three, {0.1, 0.1, 2}, 2);
  const auto from_all = TriangulationUncertainty(three, all.covariance->matrix, 2).at(q, 0.1);
  const auto from_pair = TriangulationUncertainty(pair.rig, pair.covariance->matrix).at(q, 0.1);
  EXPECT_LT(test::relative_difference(from_all->calibration, from_pair->calibration), 1e-12);
  EXPECT_PRED2(has_part, error_output([&] { pair_of(all, 3); }), "no camera 3");
}

TEST(DepthUncertainty, IntervalHoldsTheRangeAndReachesInfinityWhereRaysPart) {
  const auto near = depth_uncertainty(nominal_estimate(), {1, 5}, {.samples = 500, .seed = 3});
  for (const auto& u : near) {
    EXPECT_LT(u.interval_95_m.low, u.range_m);
    EXPECT_GT(u.interval_95_m.high, u.range_m);
    EXPECT_EQ(u.non_physical_share, 0);
  }
  const auto wild =
      depth_uncertainty(nominal_estimate(), {20}, {.psi_c = 100, .samples = 500, .seed = 3})[0];
  EXPECT_GT(wild.non_physical_share, 0.025);
  EXPECT_EQ(wild.interval_95_m.high, far_away_m);
  EXPECT_PRED2(has_part, error_output([] { depth_uncertainty(nominal_estimate(), {far_away_m}); }),
               "a range of inf m");
  EXPECT_PRED2(has_part,
               error_output([] { depth_uncertainty(nominal_estimate(), {1}, {.samples = 1}); }),
               "fewer than 2 samples");
}

TEST(SampledPropagation, NonPhysicalDrawsAreCountedAndGrowWithPsi) {
  const RigSampler sampler(nominal_estimate());
  const std::vector<PixelPair> pairs{*pixel_pair(nominal_estimate().rig, {0, 0, 15})};
  double last = -1;
  for (const double psi_c : {1.0, 30.0, 300.0}) {
    const auto point = sampled_triangulation(sampler, {}, TriangulationFrame::rig, pairs, 0,
                                             {.psi_c = psi_c, .samples = 300})[0];
    EXPECT_GT(point.non_physical_share, last);
    last = point.non_physical_share;
    const FixedPoint far{{0, 0, 1}, true};
    const auto pixel = sampled_projection(sampler, {}, 0, PointFixedTo::camera, {&far, 1},
                                          {.psi_c = psi_c, .samples = 300})[0];
    EXPECT_EQ(pixel.non_physical_share > 0, psi_c == 300.0);  // f below 0 in some
    last = std::max(last, 0.0);
  }
}

TEST(SampledPropagation, BadInputIsNamed) {
  const RigSampler sampler(nominal_estimate());
  const FixedPoint point{{0, 0, 1}, false};
  const std::span<const FixedPoint> points(&point, 1);
  EXPECT_PRED2(has_part, error_output([&] {
                 sampled_projection(sampler, {}, 0, PointFixedTo::boards, points);
               }),
               "needs their poses");
  EXPECT_PRED2(has_part, error_output([&] {
                 sampled_projection(sampler, {}, 5, PointFixedTo::camera, points);
               }),
               "no such camera");
  EXPECT_PRED2(has_part, error_output([&] {
                 sampled_projection(sampler, {}, 0, PointFixedTo::camera, points, {.samples = 1});
               }),
               "fewer than 2 samples");
  const PixelPair parting{{100, 240}, {600, 240}};
  EXPECT_PRED2(has_part, error_output([&] {
                 sampled_triangulation(sampler, {}, TriangulationFrame::rig, {&parting, 1}, 0);
               }),
               "cannot be triangulated with the rig itself");
}

TEST(Propagation, CamerasAndCovariancesThatCannotBeAreRefused) {
  const Rig& rig = nominal_estimate().rig;
  const Eigen::MatrixXd negative = -Eigen::MatrixXd::Identity(16, 16);
  const Eigen::MatrixXd& sound = nominal_estimate().covariance->matrix;
  EXPECT_NE(error_output([&] { TriangulationUncertainty(rig, negative); }).find("the variance of"),
            std::string::npos);
  EXPECT_NE(error_output([&] {
              ProjectionUncertainty(rig, negative, 0, PointFixedTo::camera);
            }).find("the variance of"),
            std::string::npos);
  RigAndBoards joint = rig_and_boards(nominal_estimate(), CovarianceChoice::honest);
  joint.rig_covariance = negative;
  for (const auto frame : {TriangulationFrame::rig, TriangulationFrame::stabilised}) {
    EXPECT_NE(error_output([&] { TriangulationUncertainty(joint, frame); }).find("the variance of"),
              std::string::npos);
  }
  EXPECT_NE(error_output([&] {
              ProjectionUncertainty(joint, 0, PointFixedTo::boards);
            }).find("the variance of"),
            std::string::npos);
  for (const int other : {-1, 0, 2}) {
    EXPECT_NE(error_output([&] {
                TriangulationUncertainty(rig, sound, other);
              }).find("cannot be paired with number " + std::to_string(other)),
              std::string::npos);
  }
}

}  // namespace
}  // namespace vernier
