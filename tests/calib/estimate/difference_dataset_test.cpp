// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "calib/board_detection.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/board_target.h"
#include "calib/calibrate.h"
#include "calib/covariance.h"
#include "calib/estimate/projection_difference.h"
#include "calib/estimate/same_rig.h"
#include "calib/lens_models.h"
#include "calib/rig_difference.h"
#include "calib/rig_estimate.h"
#include "calib/solver/normal_equations.h"
#include "calib/uncertainty/next_view.h"
#include "calib/uncertainty/target_quantity.h"
#include "tests/support/data_folder.h"

namespace vernier {

using namespace vernier::internal;

namespace {

// No covariance covers the model: on the same 13 real pairs, two models put the right camera's
// centre some ten of the bound's standard deviations apart.
TEST(RealPairs, TwoModelsDifferBeyondTheirBounds) {
  const auto data = test::data_folder();
  if (!data) GTEST_SKIP() << "VERNIER_DATA names no folder of data";
  const auto folder = (*data / "calib_opencv_case1").string();
  const ImageDetections found =
      detect_images({folder + "/left*.png", folder + "/right*.png"}, Chessboard{9, 6, 0.025});
  const RigEstimate a = calibrate(found.observations);
  const RigEstimate b = calibrate(found.observations, {.model = OpenCv4{}});
  const RigDifference d = rig_difference(a.rig, *chosen_covariance(a, CovarianceChoice::mvb), b.rig,
                                         *chosen_covariance(b, CovarianceChoice::mvb));
  EXPECT_LT(d.p_value, 1e-10);
  for (const ParameterDifference& p : d.parameters) {
    if (p.name != "right.ox_px") continue;
    RecordProperty("right_centre_in_sigma", std::to_string(p.delta / p.sigma));
    EXPECT_GT(p.delta / p.sigma, 6);  // of C_a + C_b
    const Eigen::Index k = 7;
    EXPECT_NEAR(p.delta / std::sqrt((*a.covariance_mvb)(k, k)), 11, 2);  // of radial1's alone
  }
  EXPECT_EQ(shared_views(*a.evidence, a.rig, *b.evidence, b.rig), 26);

  // Where the boards were, the projections agree within half a pixel all the same.
  const ProjectionDifference projection = projection_difference(a.rig, b.rig);
  EXPECT_LT(projection.in_focus.rms_px, 0.5);
  EXPECT_GT(projection.after.max_px, 20);  // in the corners of the images, where none was
}

BoardObservations first_frames(const BoardObservations& all, int count, int extra) {
  BoardObservations chosen = all;
  const std::vector<int> frames = frames_of(all);
  std::erase_if(chosen.views, [&](const BoardView& view) {
    return view.frame >= frames[count] && view.frame != frames[extra];
  });
  return chosen;
}

// What each of five real views would tell a calibration from eight others, against what it told.
// The prediction is made at an estimate that the new view moves, so it is near and not exact; it
// also says rightly which of the five is best.
TEST(RealPairs, PredictedGainOfAViewIsWhatItBrings) {
  const auto data = test::data_folder();
  if (!data) GTEST_SKIP() << "VERNIER_DATA names no folder of data";
  const auto folder = (*data / "calib_opencv_case1").string();
  const BoardObservations all =
      detect_images({folder + "/left*.png", folder + "/right*.png"}, Chessboard{9, 6, 0.025})
          .observations;
  const CalibrationOptions options{
      .pixel_sigma_px = 0.18, .reject_outliers = false, .white_noise = true};
  const int base = 8;
  const RigEstimate now = calibrate(first_frames(all, base, 0), options);
  const Eigen::MatrixXd F = ScaledDecomposition(*now.covariance).factor();
  const RigEstimate everything = calibrate(all, options);
  std::vector<double> predicted, found;
  for (int f = base; f < 13; ++f) {
    const RigEstimate then = calibrate(first_frames(all, base, f), options);
    BoardObservations one = all;
    std::erase_if(one.views,
                  [&](const BoardView& view) { return view.frame != frames_of(all)[f]; });
    const BoardState state{
        now.rig, {frames_of(all)[f]}, {everything.evidence->T_first_board[f]}, {0, 0}};
    const Eigen::MatrixXd S = reduced_normal_equations(one, state, 0.18).information;
    predicted.push_back(sd_of(target_quantity(now.rig, "depth", 5), updated_factor(F, S)));
    found.push_back(sd_of(target_quantity(then.rig, "depth", 5),
                          ScaledDecomposition(*then.covariance).factor()));
    RecordProperty("sd_m_view_" + std::to_string(f),
                   std::to_string(predicted.back()) + " " + std::to_string(found.back()));
    EXPECT_NEAR(predicted.back() / found.back(), 1, 0.02) << f;
  }
  const auto best = std::min_element(predicted.begin(), predicted.end()) - predicted.begin();
  EXPECT_EQ(found[best], *std::min_element(found.begin(), found.end()));
}

}  // namespace
}  // namespace vernier
