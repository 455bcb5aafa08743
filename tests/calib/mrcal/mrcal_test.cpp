// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <limits>

#include "calib/base/program_run.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/board_target.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/mrcal/board_grid.h"
#include "calib/mrcal/mrcal_comparison.h"
#include "calib/mrcal/mrcal_parameters.h"
#include "calib/mrcal/mrcal_problem.h"
#include "calib/mrcal/mrcal_solver.h"
#include "calib/mrcal/uncertainty_comparison.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/simulated_board.h"
#include "calib/solver/initial_rig.h"
#include "calib/solver/minimise_reprojection.h"
#include "calib/solver/refined_minimum.h"
#include "tests/support/error_message.h"
#include "tests/support/numeric_jacobian.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

constexpr double mrcal_sigma_px = 0.1;
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
  return simulate_board(
      rig_of(model, cameras, scale), {10, 8, 0.06},
      {.seed = 3, .frames = 24, .pixel_sigma_px = mrcal_sigma_px, .distance_m = wide ? 0.6 : 0.9});
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
  const MrcalCheck check = check_against_mrcal(observations, start, ours, mrcal_sigma_px);
  expect_agreement(check.comparison);
  EXPECT_LT(check.solution.stopped_short_sigma, 1e-3);

  const UncertaintyComparison propagated =
      compare_uncertainty(script, observations, ours, mrcal_sigma_px);
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
  expect_agreement(check_against_mrcal(board.observations, start, ours, mrcal_sigma_px).comparison);
  const UncertaintyComparison propagated =
      compare_uncertainty(script, board.observations, ours, mrcal_sigma_px);
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
        check_against_mrcal(board.observations, board.truth, ours, mrcal_sigma_px, held);
    SCOPED_TRACE(names[0]);
    expect_agreement(check.comparison);
    const UncertaintyComparison propagated =
        compare_uncertainty(script, board.observations, ours, mrcal_sigma_px, held);
    if (!propagated.absent.empty()) continue;
    EXPECT_LE(propagated.max_projection_covariance_diff, projection_covariance_gate);
  }
}

TEST(Mrcal, ComparisonShowsADifference) {
  if (!mrcal_available()) GTEST_SKIP() << "this build has no libmrcal";
  const SimulatedBoard board = board_of(Radial1{}, 2, 1);
  RefinedMinimum ours = refine_minimum(board.observations, board.truth);
  const MrcalSolution mrcals = mrcal_solve(board.observations, board.truth);
  const Eigen::VectorXd sd = mrcal_sigma_px * mrcals.unit_covariance.diagonal().cwiseSqrt();
  ours.state.rig.cameras[1].parameters[2] += 1e-5 * sd[7];
  MrcalComparison difference = compare(ours, mrcals, mrcal_sigma_px);
  EXPECT_NEAR(difference.max_parameter_diff_sigma, 1e-5, 1e-9);
  EXPECT_EQ(difference.worst_parameter, "right.cx");
  EXPECT_LE(difference.max_covariance_diff, covariance_gate);
  ours.unit_bound(2, 3) += 1e-6 * std::sqrt(ours.unit_bound(2, 2) * ours.unit_bound(3, 3));
  difference = compare(ours, mrcals, mrcal_sigma_px);
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
  const SimulatedBoard board =
      simulate_board(test::stereo_rig(Fisheye4{}), {9, 6, 0.04}, {.seed = 1});
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

TEST(Mrcal, ADifferenceThatIsNoNumberIsTheWorstAndStays) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Eigen::MatrixXd good = Eigen::MatrixXd::Identity(4, 4);
  const auto with_nan = [&](int row, int column) {
    Eigen::MatrixXd bad = good;
    bad(row, column) = nan;
    return bad;
  };
  for (const auto& [row, column] : {std::pair(0, 0), {1, 2}, {3, 3}}) {
    for (const CovarianceDifference& found : {normalised_difference(with_nan(row, column), good),
                                              normalised_difference(good, with_nan(row, column))}) {
      EXPECT_TRUE(std::isnan(found.largest));
      EXPECT_TRUE(found.row == row || found.column == column);
    }
  }
  Eigen::MatrixXd held = good, no_number = good;
  held(1, 1) = 0;  // no variance there, so no scale
  no_number(1, 1) = nan;
  EXPECT_EQ(normalised_difference(good, held).largest, 0);
  EXPECT_TRUE(std::isnan(normalised_difference(no_number, held).largest));
  EXPECT_FALSE(is_worse(1e9, nan));
  EXPECT_TRUE(is_worse(nan, 1e9));
}

TEST(Mrcal, AParameterThatIsNoNumberIsTheWorst) {
  const SimulatedBoard board = board_of(Radial1{}, 2, 1);
  const RefinedMinimum ours = refine_minimum(board.observations, board.truth);
  MrcalSolution theirs;
  theirs.state = ours.state;
  const Eigen::MatrixXd G = mrcal_by_tangent(ours.state.rig);
  theirs.unit_covariance = G * ours.unit_bound * G.transpose();
  theirs.cost_px2 = ours.cost_px2;
  EXPECT_LT(compare(ours, theirs, mrcal_sigma_px).max_parameter_diff_sigma, parameter_gate_sigma);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  theirs.state.rig.cameras[0].parameters[2] = nan;
  MrcalComparison found = compare(ours, theirs, mrcal_sigma_px);
  EXPECT_TRUE(std::isnan(found.max_parameter_diff_sigma));
  EXPECT_EQ(found.worst_parameter, "left.cx");
  theirs.state = ours.state;
  theirs.unit_covariance(3, 3) = nan;
  found = compare(ours, theirs, mrcal_sigma_px);
  EXPECT_TRUE(std::isnan(found.max_parameter_diff_sigma));
  EXPECT_TRUE(std::isnan(found.max_covariance_diff));
}

/// compare_uncertainty by a script that answers like this.
class Answer : public testing::Test {
 protected:
  UncertaintyComparison compared(const std::string& lines) {
    const std::filesystem::path file = folder_.path() / "script.py";
    std::ofstream(file) << "import json, math, runpy, sys\n" << lines;
    const RefinedMinimum ours = refine_minimum(board_.observations, board_.truth);
    return compare_uncertainty(file, board_.observations, ours, mrcal_sigma_px);
  }
  std::string error_output(const std::string& lines) {
    return test::error_message([&] { compared(lines); });
  }

  void TearDown() override { ::setenv("PATH", path_.c_str(), 1); }

  const std::string path_ = std::getenv("PATH");
  TemporaryFolder folder_;
  SimulatedBoard board_ = board_of(Pinhole{}, 2, 1);
  /// Matrices of ones in answer to everything; `change` is done to the answer.
  std::string ones(const std::string& change) {
    return "p = json.load(open(sys.argv[1]))\n"
           "square = lambda n: [[1.0] * n] * n\n"
           "a = dict(version='x', projection=[[square(2) for _ in q['points']]"
           " for q in p['projection']], triangulation=[dict(points=[[0, 0, 1] for _ in"
           " q['pixels']], calibration=[square(3) for _ in q['pixels']],"
           " observation=[square(3) for _ in q['pixels']]) for q in p['triangulation']])\n" +
           change + "\njson.dump(a, open(sys.argv[2], 'w'))\n";
  }
};

TEST_F(Answer, NullsAreNoNumbersAndTheWorst) {
  EXPECT_TRUE(std::isfinite(compared(ones("")).max_projection_covariance_diff));
  const UncertaintyComparison projection =
      compared(ones("a['projection'][0][3] = [[1, None], [None, 1]]"));
  EXPECT_TRUE(std::isnan(projection.max_projection_covariance_diff));
  EXPECT_NE(projection.worst_projection.find("left, 0.5 m"), std::string::npos);
  EXPECT_TRUE(std::isfinite(projection.max_triangulation_covariance_diff));
  const UncertaintyComparison calibration =
      compared(ones("a['triangulation'][0]['calibration'][0] = [[None] * 3] * 3"));
  EXPECT_TRUE(std::isnan(calibration.max_triangulation_covariance_diff));
  const UncertaintyComparison observation =
      compared(ones("a['triangulation'][0]['observation'][0] = [[None] * 3] * 3"));
  EXPECT_TRUE(std::isnan(observation.max_observation_covariance_diff));
}

TEST_F(Answer, WhatIsNoJsonOrTooLittleIsAnError) {
  const std::string said = "mrcal: its Python script gave an unexpected answer";
  EXPECT_NE(error_output(ones("a['projection'][0][0][0][0] = math.nan")).find(said),
            std::string::npos);
  EXPECT_NE(error_output(ones("del a['projection'][0][0]")).find(said), std::string::npos);
  EXPECT_NE(error_output(ones("del a['version']")).find(said), std::string::npos);
  EXPECT_NE(error_output("").find(said), std::string::npos);
}

TEST_F(Answer, AScriptThatFailsIsSaidAndAMissingOneIsAbsent) {
  EXPECT_NE(error_output("sys.exit('no such lens')\n").find("its Python failed: no such lens"),
            std::string::npos);
  const RefinedMinimum ours = refine_minimum(board_.observations, board_.truth);
  for (const char* missing : {"/nowhere/script.py", "script.py"}) {
    EXPECT_NE(compare_uncertainty(missing, board_.observations, ours, mrcal_sigma_px)
                  .absent.find(std::string("the script ") + missing + " is missing"),
              std::string::npos);
  }
}

TEST_F(Answer, APythonThatIsMissingDoesNotHideWhatTheFirstSaid) {
  if (!std::filesystem::exists("/usr/bin/python3")) GTEST_SKIP() << "no /usr/bin/python3";
  ASSERT_EQ(::setenv("PATH", folder_.path().c_str(), 1), 0);  // no python3 there
  EXPECT_NE(compared("print('No module named mrcal', file=sys.stderr)\nsys.exit(4)\n")
                .absent.find("no Python has mrcal: No module named mrcal"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
