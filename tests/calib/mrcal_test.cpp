// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "calib/error.h"
#include "calib/minimise_reprojection.h"
#include "calib/mrcal/board_grid.h"
#include "calib/mrcal/mrcal_comparison.h"
#include "calib/mrcal/mrcal_parameters.h"
#include "calib/mrcal/mrcal_problem.h"
#include "calib/mrcal/uncertainty_comparison.h"
#include "calib/simulated_board.h"
#include "tests/support/numeric_jacobian.h"
#include "tests/support/scenes.h"

namespace vernier {
namespace {

constexpr double sigma_px = 0.1;
const std::filesystem::path script = VERNIER_SOURCE_DIR "/python/mrcal_uncertainty.py";

/// A rig of one to three cameras with this model; `scale` enlarges the pictures.
Rig rig_of(const CameraModel& model, int cameras, int scale) {
  Rig rig = test::stereo_rig(model);
  rig.cameras.push_back(rig.cameras[0]);
  rig.cameras[2].name = "camera2";
  rig.T_camera_first.push_back(
      {rotation_from_vector({-0.02, 0.03, 0.4}), Eigen::Vector3d(0.15, -0.03, 0.01)});
  rig.cameras.resize(cameras);
  rig.T_camera_first.resize(cameras);
  for (Camera& camera : rig.cameras) {
    if (std::holds_alternative<OpenCv8>(model)) {  // a wide angle, or it is not determined
      camera.parameters[0] = 250;
      camera.parameters.tail<8>() << 0.3, 0.05, 4e-4, -3e-4, 0.01, 0.6, 0.2, 0.05;
    }
    camera.size_px *= scale;
    camera.parameters[0] *= scale;
    camera.parameters.segment<2>(2) *= scale;
  }
  return rig;
}

SimulatedBoard board_of(const CameraModel& model, int cameras, int scale) {
  const bool wide = std::holds_alternative<OpenCv8>(model);
  return simulate_board(rig_of(model, cameras, scale), {10, 8, 0.06}, 3, 0,
                        {.frames = 24, .pixel_sigma_px = sigma_px, .distance_m = wide ? 0.6 : 0.9});
}

void expect_agreement(const MrcalComparison& difference) {
  EXPECT_LE(difference.max_parameter_diff_sigma, parameter_gate_sigma)
      << difference.worst_parameter;
  EXPECT_LE(difference.max_covariance_diff, covariance_gate) << difference.worst_covariance;
  EXPECT_LE(std::abs(difference.cost_relative_diff), 1e-11);
}

struct Scene {
  const char* model;
  int cameras, scale;
};

class AgainstMrcal : public testing::TestWithParam<Scene> {};

TEST_P(AgainstMrcal, ParametersAndCovariancesAgree) {
  if (!mrcal_available()) GTEST_SKIP() << "this build has no libmrcal";
  const auto [name, cameras, scale] = GetParam();
  const CameraModel model = camera_model(name);
  const BoardObservations observations = board_of(model, cameras, scale).observations;
  const BoardState start = initial_state(observations, std::vector<CameraModel>(cameras, model));
  const RefinedMinimum ours =
      refine_minimum(observations, minimise_reprojection(observations, start));
  ASSERT_TRUE(ours.converged);
  const MrcalCheck check = check_against_mrcal(observations, start, ours, sigma_px);
  expect_agreement(check.comparison);
  EXPECT_LT(check.solution.stopped_short_sigma, 1e-3);

  const UncertaintyComparison propagated =
      compare_uncertainty(script, observations, ours, sigma_px);
  if (!propagated.absent.empty()) GTEST_SKIP() << propagated.absent;
  EXPECT_GE(propagated.projections, 150 * cameras);
  EXPECT_LE(propagated.max_projection_covariance_diff, projection_covariance_gate)
      << propagated.worst_projection;
  EXPECT_GE(propagated.triangulations, 10 * (cameras - 1));
  EXPECT_LE(propagated.max_triangulation_covariance_diff, projection_covariance_gate);
  EXPECT_LE(propagated.max_observation_covariance_diff, projection_covariance_gate);
}

std::vector<Scene> scenes() {
  std::vector<Scene> all;
  for (const char* model : {"pinhole", "radial1", "opencv4", "opencv5", "opencv8"}) {
    all.insert(all.end(), {{model, 1, 1}, {model, 2, 1}, {model, 2, 2}, {model, 3, 1}});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Models, AgainstMrcal, testing::ValuesIn(scenes()), [](const auto& info) {
  return std::string(info.param.model) + "_" + std::to_string(info.param.cameras) +
         (info.param.scale == 1 ? "_vga" : "_hd");
});

TEST(Mrcal, AgreesWhereCornersAreMissing) {
  if (!mrcal_available()) GTEST_SKIP() << "this build has no libmrcal";
  SimulatedBoard board = board_of(OpenCv4{}, 2, 1);
  for (std::size_t v = 0; v < board.observations.views.size(); ++v) {
    BoardView& view = board.observations.views[v];
    const std::size_t left = view.ids.size() - 3 * (v % 5) - v % 2;
    view.ids.erase(view.ids.begin(), view.ids.end() - left);
    view.pixels_px.erase(view.pixels_px.begin(), view.pixels_px.end() - left);
  }
  board.observations.views.erase(board.observations.views.begin() + 5);  // one camera alone there
  for (Eigen::Vector3d& X : board.observations.target_m) X += Eigen::Vector3d(-0.3, 0.1, 0);
  const BoardState start = initial_state(board.observations, {OpenCv4{}, OpenCv4{}});
  const RefinedMinimum ours =
      refine_minimum(board.observations, minimise_reprojection(board.observations, start));
  expect_agreement(check_against_mrcal(board.observations, start, ours, sigma_px).comparison);
  const UncertaintyComparison propagated =
      compare_uncertainty(script, board.observations, ours, sigma_px);
  if (!propagated.absent.empty()) GTEST_SKIP() << propagated.absent;
  EXPECT_LE(propagated.max_projection_covariance_diff, projection_covariance_gate);
}

TEST(Mrcal, AgreesWhereParametersAreHeld) {
  if (!mrcal_available()) GTEST_SKIP() << "this build has no libmrcal";
  const SimulatedBoard board = board_of(OpenCv4{}, 2, 1);
  for (const std::vector<std::string>& names : {std::vector<std::string>{"left.ax", "right.ax"},
                                                {"left.f_px", "right.ty_m"},
                                                {"left.k2"}}) {
    const std::vector<std::string> all = parameter_names(board.truth.rig);
    std::vector<bool> held(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      held[i] = std::find(names.begin(), names.end(), all[i]) != names.end();
    }
    const RefinedMinimum ours = refine_minimum(board.observations, board.truth, held);
    ASSERT_TRUE(ours.converged);
    const MrcalCheck check =
        check_against_mrcal(board.observations, board.truth, ours, sigma_px, held);
    SCOPED_TRACE(names[0]);
    expect_agreement(check.comparison);
    const UncertaintyComparison propagated =
        compare_uncertainty(script, board.observations, ours, sigma_px, held);
    if (!propagated.absent.empty()) continue;
    EXPECT_LE(propagated.max_projection_covariance_diff, projection_covariance_gate);
  }
}

TEST(Mrcal, ComparisonShowsADifference) {
  if (!mrcal_available()) GTEST_SKIP() << "this build has no libmrcal";
  const SimulatedBoard board = board_of(Radial1{}, 2, 1);
  RefinedMinimum ours = refine_minimum(board.observations, board.truth);
  const MrcalSolution mrcals = mrcal_solve(board.observations, board.truth);
  const Eigen::VectorXd sd = sigma_px * mrcals.unit_covariance.diagonal().cwiseSqrt();
  ours.state.rig.cameras[1].parameters[2] += 1e-5 * sd[7];
  MrcalComparison difference = compare(ours, mrcals, sigma_px);
  EXPECT_NEAR(difference.max_parameter_diff_sigma, 1e-5, 1e-9);
  EXPECT_EQ(difference.worst_parameter, "right.cx");
  EXPECT_LE(difference.max_covariance_diff, covariance_gate);
  ours.unit_bound(2, 3) += 1e-6 * std::sqrt(ours.unit_bound(2, 2) * ours.unit_bound(3, 3));
  difference = compare(ours, mrcals, sigma_px);
  EXPECT_NEAR(difference.max_covariance_diff, 1e-6, 1e-9);
  EXPECT_EQ(difference.worst_covariance, "left.cx, left.cy");
}

TEST(Mrcal, ConversionIsTheDerivativeOfItsParameters) {
  const Rig rig = rig_of(OpenCv5{}, 3, 1);
  const Eigen::MatrixXd numeric = test::numeric_jacobian(
      [&](const Eigen::VectorXd& delta) { return mrcal_parameters(retract(rig, delta)); },
      Eigen::VectorXd::Zero(parameter_count(rig)));
  EXPECT_LT((numeric - mrcal_by_tangent(rig)).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT(difference(rig_from_mrcal(rig, mrcal_parameters(rig)), rig).norm(), 1e-12);
  EXPECT_EQ(mrcal_parameter_names(rig)[0], "left.fx");
  EXPECT_EQ(mrcal_parameter_names(rig).back(), "camera2.tz");
}

TEST(Mrcal, GridTakesGapsAndShiftsAndNothingElse) {
  std::vector<Eigen::Vector3d> target = target_points(Chessboard{5, 4, 0.03});
  for (Eigen::Vector3d& X : target) X += Eigen::Vector3d(1, -2, 0.5);
  target.erase(target.begin() + 7);
  const BoardGrid grid = board_grid(target);
  EXPECT_EQ(grid.columns, 5);
  EXPECT_EQ(grid.rows, 4);
  EXPECT_NEAR(grid.spacing_m, 0.03, 1e-15);
  EXPECT_EQ(grid.cell[6], 6);
  EXPECT_EQ(grid.cell[7], 8);
  const auto refuses = [](const std::vector<Eigen::Vector3d>& points) {
    try {
      board_grid(points);
      ADD_FAILURE() << "no complaint";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("flat, square grid"), std::string::npos);
    }
  };
  std::vector<Eigen::Vector3d> bad = target;
  bad[3].z() += 1e-4;
  refuses(bad);
  bad = target;
  bad[3].x() += 1e-4;
  refuses(bad);
  bad = target;
  bad[3] = bad[4];
  refuses(bad);
  for (Eigen::Vector3d& X : target) X.x() *= 1.5;
  refuses(target);
}

TEST(Mrcal, ComplainsOfWhatItCannotDo) {
  const SimulatedBoard board = simulate_board(test::stereo_rig(Fisheye4{}), {9, 6, 0.04}, 1);
  try {
    mrcal_solve(board.observations, board.truth);
    FAIL() << "no complaint";
  } catch (const Error& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find(mrcal_available() ? "mrcal has no such lens model" : "no libmrcal"),
              std::string::npos)
        << what;
  }
}

TEST(Mrcal, ScriptThatFailsIsSaid) {
  const SimulatedBoard board = board_of(Pinhole{}, 1, 1);
  const RefinedMinimum ours = refine_minimum(board.observations, board.truth);
  try {
    compare_uncertainty("/nowhere/script.py", board.observations, ours, sigma_px);
    FAIL() << "no complaint";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("its Python failed"), std::string::npos);
  }
}

}  // namespace
}  // namespace vernier
