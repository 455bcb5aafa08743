// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/mrcal/mrcal_comparison.h"
#include "calib/mrcal/mrcal_parameters.h"
#include "calib/mrcal/mrcal_problem.h"
#include "calib/mrcal/mrcal_solver.h"
#include "calib/mrcal/uncertainty_comparison.h"
#include "calib/observations_file.h"
#include "calib/rig_estimate.h"
#include "calib/solver/initial_rig.h"
#include "calib/solver/refined_minimum.h"
#include "tests/support/data_folder.h"

namespace vernier {

using namespace vernier::internal;

namespace {

std::string text(double number) {
  std::ostringstream out;
  out << number;
  return out.str();
}

/// Calibration problems in the folder oracle/cases beside VERNIER_DATA.
class OracleProblem : public testing::TestWithParam<std::tuple<const char*, const char*>> {
 protected:
  void SetUp() override {
    const auto data = test::data_folder();
    if (!data) GTEST_SKIP() << "VERNIER_DATA names no folder of data";
    const auto [name, model] = GetParam();
    folder_ = *data / ".." / "oracle" / "cases" / name;
    if (!std::filesystem::exists(folder_)) GTEST_SKIP() << "no problems beside VERNIER_DATA";
    const bool hd = std::string(name).starts_with("hd");
    const Eigen::Vector2i size = hd ? Eigen::Vector2i(1280, 960) : Eigen::Vector2i(640, 480);
    model_ = camera_model(model);
    estimate_ = calibrate(read_observations(folder_ / "observations.csv", {size}),
                          {.model = model_, .pixel_sigma_px = sigma_px, .reject_outliers = false});
    const CalibrationEvidence& evidence = *estimate_.evidence;
    ours_.state = {estimate_.rig, evidence.frames, evidence.T_first_board};
    ours_.unit_bound = *estimate_.covariance_mvb / (sigma_px * sigma_px);
    ours_.cost_px2 = estimate_.calibration->chi2 * sigma_px * sigma_px;
  }

  static constexpr double sigma_px = 0.2;  // near that of every case
  std::filesystem::path folder_;
  CameraModel model_;
  RigEstimate estimate_;
  RefinedMinimum ours_;
};

using SolvedBefore = OracleProblem;

TEST_P(SolvedBefore, ParametersAndCovarianceAreWithinTheGates) {
  std::ifstream in(folder_ / ("solution_" + std::string(std::get<1>(GetParam())) + ".json"));
  const auto solution = nlohmann::json::parse(in);
  const auto theta = solution["theta"].get<std::vector<double>>();
  const auto rows = solution["cov"].get<std::vector<std::vector<double>>>();
  const double solved_sigma_px = solution["sigma"].get<double>();
  MrcalSolution mrcals;
  const auto n = static_cast<Eigen::Index>(theta.size());
  mrcals.state = ours_.state;
  mrcals.state.rig =
      rig_from_mrcal(estimate_.rig, Eigen::Map<const Eigen::VectorXd>(theta.data(), n));
  mrcals.cost_px2 = solution["cost_norm2"].get<double>();
  mrcals.unit_covariance.resize(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    mrcals.unit_covariance.row(i) = Eigen::Map<const Eigen::RowVectorXd>(rows[i].data(), n) /
                                    (solved_sigma_px * solved_sigma_px);
  }
  const MrcalComparison difference = compare(ours_, mrcals, sigma_px);
  RecordProperty("parameters_sigma", text(difference.max_parameter_diff_sigma));
  RecordProperty("covariance", text(difference.max_covariance_diff));
  EXPECT_LE(difference.max_parameter_diff_sigma, parameter_gate_sigma)
      << difference.worst_parameter;
  EXPECT_LE(difference.max_covariance_diff, covariance_gate) << difference.worst_covariance;
  EXPECT_LE(std::abs(difference.cost_relative_diff), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Mrcal,
                         SolvedBefore,
                         testing::Values(std::tuple("real_opencv", "radial1"),
                                         std::tuple("real_opencv", "opencv4"),
                                         std::tuple("real_opencv", "opencv5"),
                                         std::tuple("vga_radial1", "radial1"),
                                         std::tuple("vga_radial1", "opencv4"),
                                         std::tuple("hd_opencv4", "opencv4")),
                         [](const auto& info) {
                           return std::string(std::get<0>(info.param)) + "_" +
                                  std::get<1>(info.param);
                         });

using SolvedNow = OracleProblem;

TEST_P(SolvedNow, EverythingIsWithinTheGates) {
  if (!mrcal_available()) GTEST_SKIP() << "this build has no libmrcal";
  const BoardObservations& observations = estimate_.evidence->observations;
  const BoardState start = initial_state(observations, {model_, model_});
  const MrcalCheck check = check_against_mrcal(observations, start, ours_, sigma_px);
  RecordProperty("parameters_sigma", text(check.comparison.max_parameter_diff_sigma));
  RecordProperty("covariance", text(check.comparison.max_covariance_diff));
  RecordProperty("restarted", check.restarted);
  EXPECT_LE(check.comparison.max_parameter_diff_sigma, parameter_gate_sigma)
      << check.comparison.worst_parameter;
  EXPECT_LE(check.comparison.max_covariance_diff, covariance_gate)
      << check.comparison.worst_covariance;
  EXPECT_LE(std::abs(check.comparison.cost_relative_diff), 1e-11);
  const UncertaintyComparison propagated = compare_uncertainty(
      VERNIER_SOURCE_DIR "/python/mrcal_uncertainty.py", observations, ours_, sigma_px);
  if (!propagated.absent.empty()) GTEST_SKIP() << propagated.absent;
  RecordProperty("projection", text(propagated.max_projection_covariance_diff));
  RecordProperty("triangulation", text(propagated.max_triangulation_covariance_diff));
  EXPECT_LE(propagated.max_projection_covariance_diff, projection_covariance_gate)
      << propagated.worst_projection;
  EXPECT_LE(propagated.max_triangulation_covariance_diff, projection_covariance_gate);
  EXPECT_LE(propagated.max_observation_covariance_diff, projection_covariance_gate);
}

// Not opencv8: these views, of narrow lenses, leave its eight coefficients in a curved valley of
// the cost (numerator and denominator cancel), where neither program reaches a minimum.
INSTANTIATE_TEST_SUITE_P(
    Mrcal,
    SolvedNow,
    testing::Combine(testing::Values("real_opencv", "vga_radial1", "hd_opencv4"),
                     testing::Values("pinhole", "radial1", "opencv4", "opencv5")),
    [](const auto& info) {
      return std::string(std::get<0>(info.param)) + "_" + std::get<1>(info.param);
    });

}  // namespace
}  // namespace vernier
