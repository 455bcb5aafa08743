// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/validation/view_influence.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "calib/board_observations.h"
#include "calib/calibrate.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/simulated_board.h"
#include "tests/support/error_message.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

constexpr int frames = 12;

BoardObservations some_views(std::uint64_t seed, double noise_px = 0.2) {
  return simulate_board(test::stereo_rig(), {},
                        {.seed = seed, .frames = frames, .pixel_sigma_px = noise_px})
      .observations;
}

/// |L⁻¹ δ|² in the bound, all of whose rows are above zero.
double mahalanobis(const Eigen::VectorXd& delta, const Eigen::MatrixXd& bound) {
  const Eigen::VectorXd sd = bound.diagonal().cwiseSqrt();
  const Eigen::MatrixXd scaled =
      sd.cwiseInverse().asDiagonal() * bound * sd.cwiseInverse().asDiagonal();
  const Eigen::VectorXd d = delta.cwiseQuotient(sd);
  return std::sqrt(d.dot(scaled.ldlt().solve(d)));
}

double total_leverage(const std::vector<ViewInfluence>& influences) {
  double sum = 0;
  for (const ViewInfluence& one : influences) sum += one.leverage;
  return sum;
}

TEST(ViewInfluence, MovesCancelAndLeveragesAddUpToTheParameters) {
  const RigEstimate estimate = calibrate(some_views(41));
  const auto influences = view_influence(estimate);
  ASSERT_EQ(influences.size(), static_cast<std::size_t>(frames));
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(16);
  for (const ViewInfluence& one : influences) {
    sum += one.delta;
    EXPECT_NEAR(one.influence, mahalanobis(one.delta, *estimate.covariance_mvb), 1e-6);
    EXPECT_EQ(one.corners, 2 * 54);
    EXPECT_GT(one.leave_one_out_influence, one.influence);
  }
  EXPECT_LT(mahalanobis(sum, *estimate.covariance_mvb), 1e-4);
  EXPECT_NEAR(total_leverage(influences), 16, 1e-6);
}

TEST(ViewInfluence, FramesResidualsMakeUpTheWhole) {
  const RigEstimate estimate = calibrate(some_views(42));
  double squares = 0;
  int corners = 0;
  for (const ViewInfluence& one : view_influence(estimate)) {
    squares += one.rms_px * one.rms_px * one.corners;
    corners += one.corners;
  }
  EXPECT_NEAR(std::sqrt(squares / corners), estimate.calibration->rms_px, 1e-9);
}

TEST(ViewInfluence, HeldParametersDoNotMove) {
  const RigEstimate estimate =
      calibrate(some_views(43), {.held = {{"left.ax", 1.002}, {"right.k1", -0.132}}});
  const auto influences = view_influence(estimate);
  EXPECT_NEAR(total_leverage(influences), 14, 1e-6);
  const auto names = parameter_names(estimate.rig);
  const auto k1 = std::find(names.begin(), names.end(), "right.k1") - names.begin();
  for (const ViewInfluence& one : influences) {
    EXPECT_EQ(one.delta[1], 0);
    EXPECT_EQ(one.leave_one_out_delta[k1], 0);
  }
}

TEST(ViewInfluence, PriorTakesItsShareOfTheLeverage) {
  // A prior that says of left.f_px what the views say: half of that parameter is its.
  const BoardObservations views = some_views(44);
  const RigEstimate free = calibrate(views, {.pixel_sigma_px = 0.2});
  const double sigma = std::sqrt((*free.covariance_mvb)(0, 0));
  const RigEstimate known = calibrate(
      views, {.pixel_sigma_px = 0.2, .known = {{"left.f_px", free.rig.cameras[0].f_px(), sigma}}});
  EXPECT_NEAR(total_leverage(view_influence(known)), 15.5, 1e-6);
}

TEST(ViewInfluence, MoveIfLeftOutIsWhatCalibratingWithoutTheFrameGives) {
  const BoardObservations views = some_views(45, 0.01);  // so little noise that first order is all
  const RigEstimate whole = calibrate(views, {.pixel_sigma_px = 0.01});
  for (const ViewInfluence& one : view_influence(whole)) {
    if (one.frame % 4 != 0) continue;
    BoardObservations rest = views;
    std::erase_if(rest.views, [&](const BoardView& view) { return view.frame == one.frame; });
    const Eigen::VectorXd moved =
        difference(calibrate(rest, {.pixel_sigma_px = 0.01}).rig, whole.rig);
    EXPECT_LT(mahalanobis(moved - one.leave_one_out_delta, *whole.covariance_mvb),
              0.02 * one.leave_one_out_influence)
        << "frame " << one.frame;
  }
}

TEST(ViewInfluence, FrameWithAnErrorOfItsOwnStandsOut) {
  BoardObservations views = some_views(46);
  for (BoardView& view : views.views) {
    if (view.frame != 5 || view.camera != 0) continue;
    for (Eigen::Vector2d& q : view.pixels_px) q.y() += 1;  // it moved between the two exposures
  }
  const auto influences =
      view_influence(calibrate(views, {.pixel_sigma_px = 0.2, .reject_outliers = false}));
  const auto worst =
      std::max_element(influences.begin(), influences.end(),
                       [](const auto& a, const auto& b) { return a.influence < b.influence; });
  EXPECT_EQ(worst->frame, 5);
  EXPECT_GT(worst->influence, 3 * worst->expected_influence);
}

TEST(ViewInfluence, SaysWhatIsMissing) {
  RigEstimate estimate = calibrate(some_views(47));
  RigEstimate without = estimate;
  without.evidence.reset();
  EXPECT_NE(test::error_message([&] {
              view_influence(without, "a.json");
            }).find("a.json: it has no evidence"),
            std::string::npos);
  without = estimate;
  without.calibration.reset();
  EXPECT_NE(test::error_message([&] { view_influence(without); }).find("pixel noise is unknown"),
            std::string::npos);
  without = estimate;
  without.covariance_mvb.reset();
  EXPECT_NE(test::error_message([&] { view_influence(without); }).find("no minimum variance bound"),
            std::string::npos);
}

TEST(ViewInfluence, AViewOfAnUnknownFrameIsAnError) {
  RigEstimate estimate = calibrate(some_views(41));
  estimate.evidence->observations.views.back().frame = 99;
  EXPECT_EQ(test::error_message([&] { view_influence(estimate); }),
            "frame 99: it has a view but no board pose; give one board pose for every "
            "frame with views");
  estimate.evidence->frames.push_back(99);
  EXPECT_NE(test::error_message([&] {
              view_influence(estimate);
            }).find("its evidence does not have one board pose per frame"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
