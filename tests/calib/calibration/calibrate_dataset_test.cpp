// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "calib/board_detection.h"
#include "calib/board_target.h"
#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/observations_file.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "tests/support/data_folder.h"

namespace vernier {
namespace {

/// Our parameters as mrcal has them: fx fy cx cy k… a camera, rotation vector, translation.
Eigen::VectorXd as_mrcal(const Rig& rig) {
  std::vector<double> a;
  for (const Camera& camera : rig.cameras) {
    a.insert(a.end(), {camera.f_px() * camera.ax(), camera.f_px(), camera.ox_px(), camera.oy_px()});
    a.insert(a.end(), camera.parameters.begin() + 4, camera.parameters.end());
  }
  const Eigen::Vector3d w = vector_from_rotation(rig.T_camera_first[1].R);
  a.insert(a.end(), w.begin(), w.end());
  a.insert(a.end(), rig.T_camera_first[1].t.begin(), rig.T_camera_first[1].t.end());
  return Eigen::Map<Eigen::VectorXd>(a.data(), static_cast<Eigen::Index>(a.size()));
}

/// Solved problems of mrcal, in the folder oracle/cases beside VERNIER_DATA.
class OracleCase
    : public testing::TestWithParam<std::tuple<const char*, const char*, Eigen::Vector2i>> {};

TEST_P(OracleCase, ParametersAgreeWithMrcal) {
  const auto data = test::data_folder();
  if (!data) GTEST_SKIP() << "VERNIER_DATA names no folder of data";
  const auto [name, model, size] = GetParam();
  const auto folder = *data / ".." / "oracle" / "cases" / name;
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no solved problems beside VERNIER_DATA";
  const auto observations = read_observations(folder / "observations.csv", {size});
  const RigEstimate estimate =
      calibrate(observations, {.model = camera_model(model), .pixel_sigma_px = 1});

  std::ifstream in(folder / ("solution_" + std::string(model) + ".json"));
  const auto solution = nlohmann::json::parse(in);
  const auto theta = solution["theta"].get<std::vector<double>>();
  const auto stdev = solution["stdev"].get<std::vector<double>>();
  const double sigma = solution["sigma"].get<double>();
  const Eigen::VectorXd ours = as_mrcal(estimate.rig);
  ASSERT_EQ(ours.size(), static_cast<Eigen::Index>(theta.size()));
  double worst = 0;
  for (Eigen::Index i = 0; i < ours.size(); ++i) {
    worst = std::max(worst, std::abs(ours[i] - theta[i]) / stdev[i]);
  }
  std::ostringstream text;
  text << worst;
  RecordProperty("worst_difference_in_sigma", text.str());
  EXPECT_LT(worst, 1e-4);
  EXPECT_NEAR(estimate.calibration->chi2, solution["cost_norm2"].get<double>(),
              1e-8 * solution["cost_norm2"].get<double>());
  // variances that no conversion touches: centres, distortion, translation
  for (const int i : {2, 3, 4}) {
    EXPECT_NEAR(sigma * std::sqrt((*estimate.covariance_mvb)(i, i)) / stdev[i], 1, 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Mrcal,
    OracleCase,
    testing::Values(std::tuple("real_opencv", "radial1", Eigen::Vector2i(640, 480)),
                    std::tuple("real_opencv", "opencv4", Eigen::Vector2i(640, 480)),
                    std::tuple("real_opencv", "opencv5", Eigen::Vector2i(640, 480)),
                    std::tuple("vga_radial1", "radial1", Eigen::Vector2i(640, 480)),
                    std::tuple("hd_opencv4", "opencv4", Eigen::Vector2i(1280, 960))),
    [](const auto& info) {
      return std::string(std::get<0>(info.param)) + "_" + std::get<1>(info.param);
    });

TEST(RealPairs, BothModelsFitWithinTheirBounds) {
  const auto data = test::data_folder();
  if (!data) GTEST_SKIP() << "VERNIER_DATA names no folder of data";
  const auto folder = (*data / "calib_opencv_case1").string();
  const ImageDetections found =
      detect_images({folder + "/left*.png", folder + "/right*.png"}, Chessboard{9, 6, 0.025});
  EXPECT_EQ(found.observations.views.size(), 26u);
  const RigEstimate radial = calibrate(found.observations);
  EXPECT_LE(radial.calibration->rms_px, 0.20);
  EXPECT_EQ(radial.calibration->views, 13);
  EXPECT_LE(calibrate(found.observations, {.model = OpenCv5{}}).calibration->rms_px, 0.16);
}

TEST(RealPairs, BoardOfAnotherSizeIsNotTaken) {
  const auto data = test::data_folder();
  if (!data) GTEST_SKIP() << "VERNIER_DATA names no folder of data";
  const auto folder = (*data / "calib_opencv_case1").string();
  try {
    detect_images({folder + "/left*.png", folder + "/right*.png"}, Chessboard{8, 6, 0.025});
    FAIL() << "no Error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("seems to have more inner corners than the 8x6 board"),
              std::string::npos)
        << error.what();
  }
}

TEST(RealPairs, PoorWideAngleImagesAreAllFound) {
  const auto data = test::data_folder();
  if (!data) GTEST_SKIP() << "VERNIER_DATA names no folder of data";
  const auto folder = (*data / "calib_aliyasin_outliers").string();
  const ImageDetections found =
      detect_images({folder + "/left*.png", folder + "/right*.png"}, Chessboard{9, 6, 0.025});
  EXPECT_EQ(found.observations.views.size(), 32u);
  EXPECT_LE(calibrate(found.observations, {.model = OpenCv5{}}).calibration->rms_px, 0.2);
}

}  // namespace
}  // namespace vernier
