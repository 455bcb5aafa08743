// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/residual_diagnosis.h"

#include <gtest/gtest.h>

#include "calib/board/board_warp.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/calibration/outliers.h"
#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/simulated_board.h"
#include "calib/solver/initial_rig.h"
#include "calib/solver/minimise_reprojection.h"
#include "tests/support/board_defects.h"
#include "tests/support/scenes.h"
#include "tests/support/wide_views.h"

namespace vernier {

using namespace vernier::internal;

namespace {

/// What is found first, and the solution as it stands, without outliers left out.
struct Found {
  std::vector<ResidualFinding> findings;
  double sigma_px = 0;

  std::string first() const { return findings.empty() ? "" : findings[0].text; }
};

Found found_in(const BoardObservations& observations, const CameraModel& model = Radial1{}) {
  const BoardState state = minimise_reprojection(
      observations,
      initial_state(observations, std::vector<CameraModel>(observations.size_px.size(), model)));
  return {diagnose_residuals(observations, state, {}),
          robust_pixel_sigma(corner_residuals(observations, state))};
}

class ResidualDiagnosis : public testing::Test {
 protected:
  const Rig rig_ = test::stereo_rig();
  BoardObservations good_ = simulate_board(rig_, {}, {.seed = 7, .frames = 15}).observations;
};

TEST_F(ResidualDiagnosis, WhiteNoiseHasNoCause) { EXPECT_EQ(found_in(good_).first(), ""); }

TEST_F(ResidualDiagnosis, AnotherLensIsNamedAndItsModelHelps) {
  Rig wide = test::stereo_rig(Fisheye4{});
  for (Camera& camera : wide.cameras) {
    camera.parameters.head<8>() << 305, 1, 320, 240, -0.02, 0.005, -0.002, 0.0003;
  }
  wide.T_camera_first[1].t.x() = -0.06;
  const auto seen =
      simulate_board(wide, {}, {.seed = 7, .frames = 15, .distance_m = 0.25, .tilt_rad = 0.35})
          .observations;
  const Found found = found_in(seen);
  EXPECT_EQ(found.first().find("the lens needs another model: "), 0u) << found.first();
  // follow the advice
  const std::string name = found.first().substr(found.first().rfind(' ') + 1);
  const RigEstimate better = calibrate(seen, {.model = camera_model(name)});
  EXPECT_EQ(name, "fisheye4");
  EXPECT_LT(better.calibration->rms_px, 0.25) << name;
  EXPECT_TRUE(better.calibration->trust_warnings.empty());
}

// opencv8 has two words of parameters more than radial1: nothing of the poorer problem may be asked
// of it.
TEST_F(ResidualDiagnosis, ALensIsNamedForFourCameras) {
  Rig wide;
  for (int c = 0; c < 4; ++c) {
    Camera camera = test::stereo_rig(Fisheye4{}).cameras[0];
    camera.name = "camera" + std::to_string(c);
    camera.parameters << 305, 1, 320, 240, -0.02, 0.005, -0.002, 0.0003;
    wide.cameras.push_back(camera);
    wide.T_camera_first.push_back(
        {Eigen::Matrix3d::Identity(), {-0.05 * (c % 2), 0.05 * (c / 2), 0}});
  }
  const auto seen =
      simulate_board(wide, {}, {.seed = 7, .frames = 12, .distance_m = 0.2, .tilt_rad = 0.35})
          .observations;
  const RigEstimate estimate = calibrate(seen, {.model = Radial1{}});
  ASSERT_EQ(estimate.calibration->trust_warnings.size(), 1u);
  EXPECT_NE(estimate.calibration->trust_warnings[0].find("the lens needs another model: "),
            std::string::npos)
      << estimate.calibration->trust_warnings[0];
}

// fisheye4 has no rays for one corner in a hundred, and explains all others.
TEST_F(ResidualDiagnosis, AWideLensIsNamedAndNeitherFramesNorPixelsAreDoubted) {
  const auto [seen, beyond] =
      test::wide_views(test::wide_rig(), {.most_deg = 96, .square_m = 0.035, .from_axis_deg = 75});
  ASSERT_GT(beyond, 20);
  for (const CameraModel& model : {CameraModel{Radial1{}}, CameraModel{OpenCv5{}}}) {
    const std::vector<std::string> doubts =
        calibrate(seen, {.model = model}).calibration->trust_warnings;
    ASSERT_EQ(doubts.size(), 1u) << doubts[0];
    EXPECT_NE(doubts[0].find("the lens needs another model: fisheye4 fits the same corners to 0.2"),
              std::string::npos)
        << doubts[0];
    EXPECT_EQ(doubts[0].find("pixels"), std::string::npos) << doubts[0];
    EXPECT_EQ(doubts[0].find("pose"), std::string::npos) << doubts[0];
  }
}

TEST_F(ResidualDiagnosis, ABentBoardIsNamedWithItsShape) {
  const Eigen::Vector2d warp_m(0.004, -0.002);
  const SimulatedBoard drawn =
      simulate_board(rig_, {}, {.seed = 7, .frames = 15, .distance_m = 0.6});
  BoardObservations seen = drawn.observations;
  const auto bent = warped_target(seen.target_m, warp_m);
  for (BoardView& view : seen.views) {
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      const Pose T = rig_.T_camera_first[view.camera] * drawn.truth.T_first_board[view.frame];
      const auto pixel = [&](const Eigen::Vector3d& X) {
        return project(rig_.cameras[view.camera], T * X);
      };
      view.pixels_px[i] += pixel(bent[view.ids[i]]) - pixel(seen.target_m[view.ids[i]]);
    }
  }
  const Found found = found_in(seen);
  EXPECT_EQ(found.first().find(
                "the board is not flat: a warp of 3.9 mm in x and -2 mm in y fits to 0.20 px"),
            0u)
      << found.first();
}

TEST_F(ResidualDiagnosis, FramesTakenAtTwoTimesAreNamedAndLeavingThemOutHelps) {
  for (const int frame : {3, 9}) {
    for (auto& pixel : test::view_of(good_, frame, 1).pixels_px) pixel.y() += 12;
  }
  const Found found = found_in(good_);
  EXPECT_EQ(found.first().find("cameras 0 and 1 did not see the board at the same pose in 2 of 15 "
                               "frames (each image fits alone, but not both together): 3 ("),
            0u)
      << found.first();
  std::erase_if(good_.views, [](const BoardView& v) { return v.frame == 3 || v.frame == 9; });
  EXPECT_EQ(found_in(good_).first(), "");
}

TEST_F(ResidualDiagnosis, ImagesThatCarryTheMisfitAreNamed) {
  BoardView& view = test::view_of(good_, 4, 0);
  view.image = "left04.png";
  for (std::size_t i = 0; i < view.pixels_px.size(); ++i) {
    view.pixels_px[i].x() += i % 3 == 0 ? 6 : i % 3 == 1 ? -6 : 0;
  }
  const Found found = found_in(good_);
  EXPECT_EQ(found.first().find("1 of 30 images account for 9"), 0u) << found.first();
  EXPECT_NE(found.first().find("frame 4, camera 0 (left04.png) ("), std::string::npos);
  EXPECT_NE(found.first().find("the others have 0.2"), std::string::npos) << found.first();
}

TEST_F(ResidualDiagnosis, ACameraOutOfFocusIsNamed) {
  for (BoardView& view : good_.views) {
    if (view.camera == 0) continue;
    for (std::size_t i = 0; i < view.pixels_px.size(); ++i) {
      view.pixels_px[i].x() += i * 7 % 3 == 0 ? 2 : i * 7 % 3 == 1 ? -2 : 0;
      view.pixels_px[i].y() += i * 5 % 4 < 2 ? 1.5 : -1.5;
    }
  }
  bool named = false;
  for (const ResidualFinding& finding : found_in(good_).findings) {
    named |= finding.text.find("camera 1 (\"right\") has residuals of ") == 0;
  }
  EXPECT_TRUE(named);
}

TEST_F(ResidualDiagnosis, SquaresThatAreNotSquareAreSuspected) {
  for (auto& X : good_.target_m) X.y() *= 1.2;
  bool suspected = false;
  for (const ResidualFinding& finding : found_in(good_).findings) {
    suspected |= finding.text.find("the board's squares are not square") != std::string::npos;
  }
  EXPECT_TRUE(suspected);
}

TEST_F(ResidualDiagnosis, CalibrateSaysItAsADoubt) {
  for (BoardView& view : good_.views) {
    if (view.camera == 1 && view.frame % 2 == 0) {
      for (auto& pixel : view.pixels_px) pixel.y() += 12;
    }
  }
  const RigEstimate estimate = calibrate(good_, {.reject_outliers = false});
  ASSERT_EQ(estimate.calibration->trust_warnings.size(), 1u);
  EXPECT_NE(estimate.calibration->trust_warnings[0].find(
                "px exceed corner noise: cameras 0 and 1 did not see the board at the same pose"),
            std::string::npos)
      << estimate.calibration->trust_warnings[0];
}

}  // namespace
}  // namespace vernier
