// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/observations_file.h"
#include "calib/projection_uncertainty.h"
#include "calib/rig_and_boards.h"
#include "calib/rig_estimate.h"
#include "calib/triangulation.h"
#include "calib/triangulation_uncertainty.h"
#include "tests/support/data_folder.h"
#include "tests/support/relative_difference.h"

namespace vernier {
namespace {

/// Matrix of a JSON list of rows.
Eigen::MatrixXd matrix(const nlohmann::json& json) {
  const auto rows = json.get<std::vector<std::vector<double>>>();
  Eigen::MatrixXd m(rows.size(), rows.at(0).size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    m.row(static_cast<Eigen::Index>(i)) = Eigen::Map<const Eigen::RowVectorXd>(
        rows[i].data(), static_cast<Eigen::Index>(rows[i].size()));
  }
  return m;
}

Eigen::Vector2d pixel(const nlohmann::json& json) {
  return {json[0].get<double>(), json[1].get<double>()};
}

std::string number_text(double number) {
  std::ostringstream out;
  out << number;
  return out.str();
}

/// Solved problems of mrcal, in the folder oracle/cases beside VERNIER_DATA, with what mrcal
/// propagates from them.
class Propagated
    : public testing::TestWithParam<std::tuple<const char*, const char*, Eigen::Vector2i>> {
 protected:
  void SetUp() override {
    const auto data = test::data_folder();
    if (!data) GTEST_SKIP() << "VERNIER_DATA names no folder of data";
    const auto [name, model, size] = GetParam();
    const auto folder = *data / ".." / "oracle" / "cases" / name;
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no solved problems beside VERNIER_DATA";
    std::ifstream in(folder / ("solution_" + std::string(model) + ".json"));
    solution_ = nlohmann::json::parse(in);
    estimate_ = calibrate(read_observations(folder / "observations.csv", {size}),
                          {.model = camera_model(model),
                           .pixel_sigma_px = solution_["sigma"].get<double>(),
                           .reject_outliers = false});
  }

  nlohmann::json solution_;
  RigEstimate estimate_;
};

TEST_P(Propagated, ProjectionCovarianceIsMrcals) {
  const RigAndBoards joint = rig_and_boards(estimate_, CovarianceChoice::mvb);
  double worst = 0;
  int compared = 0;
  for (const auto& grid : solution_["projection"]) {
    const ProjectionUncertainty ours(joint, grid["camera"].get<int>(), PointFixedTo::boards);
    const double distance_m = grid["distance"].is_string() ? std::numeric_limits<double>::infinity()
                                                           : grid["distance"].get<double>();
    for (std::size_t row = 0; row < grid["q"].size(); ++row) {
      for (std::size_t column = 0; column < grid["q"][row].size(); ++column) {
        const auto C = ours.covariance(pixel(grid["q"][row][column]), distance_m);
        ASSERT_TRUE(C);
        worst = std::max(worst, test::relative_difference(*C, matrix(grid["cov"][row][column])));
        ++compared;
      }
    }
  }
  RecordProperty("worst_relative_difference", number_text(worst));
  EXPECT_EQ(compared, 2 * 6 * 48);  // cameras, distances (infinity among them), pixels
  EXPECT_LT(worst, 1e-6);
}

TEST_P(Propagated, TriangulationCovarianceIsMrcals) {
  const RigAndBoards joint = rig_and_boards(estimate_, CovarianceChoice::mvb);
  const double sigma_px = solution_["sigma"].get<double>();
  const auto& pixels = solution_["triangulation"]["q"];
  const auto pair = [&](std::size_t i) {
    return PixelPair{pixel(pixels[i][0]), pixel(pixels[i][1])};
  };
  for (const auto& [key, frame] : {std::pair("raw_cam0", TriangulationFrame::rig),
                                   std::pair("stabilized", TriangulationFrame::stabilised)}) {
    const auto& theirs = solution_["triangulation"][key];
    const TriangulationUncertainty ours(joint, frame);
    double worst_point = 0, worst_calibration = 0, worst_observation = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const auto point = ours.at(pair(i), sigma_px);
      ASSERT_TRUE(point);
      const auto x = theirs["p"][i].get<std::vector<double>>();
      const Eigen::Map<const Eigen::Vector3d> x_theirs(x.data());
      worst_point = std::max(worst_point, (point->x_m - x_theirs).norm() / x_theirs.norm());
      worst_observation = std::max(
          worst_observation,
          test::relative_difference(point->observation, matrix(theirs["Var_observation"][i])));
      for (std::size_t j = 0; j < pixels.size(); ++j) {
        Eigen::Matrix3d between;
        for (int a = 0; a < 3; ++a) {
          for (int b = 0; b < 3; ++b) {
            between(a, b) = theirs["Var_calibration"][i][a][j][b].get<double>();
          }
        }
        worst_calibration = std::max(
            worst_calibration, test::relative_difference(*ours.between(pair(i), pair(j)), between));
        if (i == j) {
          EXPECT_LT(test::relative_difference(point->calibration, between), 1e-6);
        }
      }
    }
    const std::string name = key;
    RecordProperty(name + "_point", number_text(worst_point));
    RecordProperty(name + "_observation", number_text(worst_observation));
    RecordProperty(name + "_calibration", number_text(worst_calibration));
    EXPECT_LT(worst_point, 1e-6);
    EXPECT_LT(worst_observation, 1e-6);
    EXPECT_LT(worst_calibration, 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Mrcal,
    Propagated,
    testing::Values(std::tuple("real_opencv", "radial1", Eigen::Vector2i(640, 480)),
                    std::tuple("real_opencv", "opencv4", Eigen::Vector2i(640, 480)),
                    std::tuple("real_opencv", "opencv5", Eigen::Vector2i(640, 480)),
                    std::tuple("vga_radial1", "radial1", Eigen::Vector2i(640, 480)),
                    std::tuple("vga_radial1", "opencv4", Eigen::Vector2i(640, 480)),
                    std::tuple("hd_opencv4", "opencv4", Eigen::Vector2i(1280, 960))),
    [](const auto& info) {
      return std::string(std::get<0>(info.param)) + "_" + std::get<1>(info.param);
    });

}  // namespace
}  // namespace vernier
