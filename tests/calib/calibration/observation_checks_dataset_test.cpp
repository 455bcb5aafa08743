// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "calib/board_detection.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/board_target.h"
#include "calib/calibrate.h"
#include "calib/calibration/observation_checks.h"
#include "calib/calibration/view_checks.h"
#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/lens_models.h"
#include "calib/observations_file.h"
#include "calib/rig_estimate.h"
#include "calib/solver/initial_rig.h"
#include "tests/support/board_defects.h"
#include "tests/support/data_folder.h"
#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::internal;

namespace {

/// A set of real pairs of a 9x6 board and what is left of it at most.
struct RealSet {
  const char* folder;
  double rms_px;
};

class RealPairs : public testing::TestWithParam<RealSet> {
 protected:
  void SetUp() override {
    const auto data = test::data_folder();
    if (!data) GTEST_SKIP() << "VERNIER_DATA names no folder of data";
    const std::string folder = (*data / GetParam().folder).string();
    observations_ =
        detect_images({folder + "/left*.png", folder + "/right*.png"}, Chessboard{9, 6, 0.025})
            .observations;
    check_and_sort(observations_);
  }

  BoardObservations observations_;
};

TEST_P(RealPairs, AreNotComplainedOf) {
  ObservationDiagnosis said = check_observations(observations_);
  said.add(check_views(observations_, initial_state(observations_, {Radial1{}, Radial1{}})));
  EXPECT_TRUE(said.trust_warnings.empty()) << said.trust_warnings[0];
  EXPECT_TRUE(said.warnings.empty()) << said.warnings[0];
}

TEST_P(RealPairs, StartByThemselvesWithEveryModel) {
  for (const char* model : {"radial1", "opencv4", "opencv5", "fisheye4"}) {
    const RigEstimate estimate = calibrate(observations_, {.model = camera_model(model)});
    EXPECT_LT(estimate.calibration->rms_px, GetParam().rms_px) << model;
    EXPECT_TRUE(estimate.calibration->trust_warnings.empty()) << model;
  }
  const BoardState radial = initial_state(observations_, {Radial1{}, Radial1{}});
  const BoardState rational = initial_state(observations_, {OpenCv8{}, OpenCv8{}});
  EXPECT_NEAR(rational.rig.cameras[0].f_px() / radial.rig.cameras[0].f_px(), 1, 0.1);
}

TEST_P(RealPairs, ATurnedViewAndASwappedFrameAreNamed) {
  const auto complaint_of = [](const BoardObservations& observations) {
    return test::error_message([&] {
      check_views(observations, initial_state(observations, {Radial1{}, Radial1{}}));
    });
  };
  BoardObservations turned = observations_;
  test::half_turn(test::view_of(turned, 5, 1));
  EXPECT_EQ(complaint_of(turned).find("frame 5, camera "), 0u);
  EXPECT_NE(complaint_of(turned).find("half a turn"), std::string::npos);
  BoardObservations swapped = observations_;
  test::exchange(swapped, 5);
  EXPECT_NE(complaint_of(swapped).find("left and right are swapped"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Sets,
                         RealPairs,
                         testing::Values(RealSet{"calib_opencv_case1", 0.2},
                                         RealSet{"calib_aliyasin_outliers", 0.35}),
                         [](const auto& info) { return std::string(info.param.folder); });

/// Solved problems of mrcal, in the folder oracle/cases beside VERNIER_DATA.
TEST(SolvedProblems, AreNotComplainedOf) {
  const auto data = test::data_folder();
  if (!data) GTEST_SKIP() << "VERNIER_DATA names no folder of data";
  for (const auto& [name, size] : {std::pair("vga_radial1", Eigen::Vector2i(640, 480)),
                                   std::pair("hd_opencv4", Eigen::Vector2i(1280, 960))}) {
    const auto file = *data / ".." / "oracle" / "cases" / name / "observations.csv";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no solved problems beside VERNIER_DATA";
    const BoardObservations seen = read_observations(file, {size});
    ObservationDiagnosis said = check_observations(seen);
    said.add(check_views(seen, initial_state(seen, {Radial1{}, Radial1{}})));
    EXPECT_TRUE(said.trust_warnings.empty()) << name << ": " << said.trust_warnings[0];
  }
}

}  // namespace
}  // namespace vernier
