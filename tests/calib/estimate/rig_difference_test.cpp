// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/rig_difference.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "calib/board_observations.h"
#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/estimate/same_rig.h"
#include "calib/estimate/stable_coordinates.h"
#include "calib/lens_models.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/simulated_board.h"
#include "calib/statistics/distributions.h"
#include "tests/support/error_message.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

RigEstimate calibrated(std::uint64_t seed, const CameraModel& model = Radial1{}) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = seed, .frames = 12});
  return calibrate(board.observations,
                   {.model = model, .pixel_sigma_px = 0.2, .white_noise = true});
}

RigDifference of(const RigEstimate& a, const RigEstimate& b) {
  return rig_difference(a.rig, *a.covariance, b.rig, *b.covariance);
}

bool says(const std::vector<std::string>& lines, const std::string& words) {
  return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
    return line.find(words) != std::string::npos;
  });
}

TEST(RigDifference, IsNothingForTheSameRig) {
  const RigEstimate a = calibrated(1);
  const RigDifference d = of(a, a);
  EXPECT_LT(d.mahalanobis2, 1e-20);
  EXPECT_EQ(d.dof, 16);
  EXPECT_EQ(d.p_value, 1);
  EXPECT_EQ(d.parameters.size(), 16u);
  EXPECT_TRUE(d.only_in_a.empty() && d.only_in_b.empty() && d.fixed_at_different_values.empty());
}

TEST(RigDifference, IsTheQuadraticFormAndTheSumOfItsDirections) {
  const RigEstimate a = calibrated(1), b = calibrated(2);
  const RigDifference d = of(a, b);
  const Eigen::VectorXd delta = difference(b.rig, a.rig);
  const Eigen::MatrixXd C = a.covariance->matrix + b.covariance->matrix;
  const auto at = StableCoordinates(a.rig, C).try_position(b.rig);
  const Eigen::MatrixXd moved =
      a.covariance->matrix + at->by_rig * b.covariance->matrix * at->by_rig.transpose();
  EXPECT_NEAR(d.mahalanobis2, at->delta.dot(Eigen::LLT<Eigen::MatrixXd>(moved).solve(at->delta)),
              1e-6 * d.mahalanobis2);
  // The lens is wide: the tangent serves as well.
  EXPECT_NEAR(d.mahalanobis2, delta.dot(Eigen::LLT<Eigen::MatrixXd>(C).solve(delta)),
              0.03 * d.mahalanobis2);
  EXPECT_EQ(d.p_value, chi_squared_survival(d.mahalanobis2, 16));
  double sum = 0;
  for (std::size_t k = 0; k < d.directions.size(); ++k) {
    sum += d.directions[k].in_sigma * d.directions[k].in_sigma;
    EXPECT_LE(d.directions[k].in_sigma, d.directions[k ? k - 1 : 0].in_sigma);
  }
  EXPECT_NEAR(sum, d.mahalanobis2, 1e-9 * sum);
  for (std::size_t i = 0; i < 16; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    EXPECT_EQ(d.parameters[i].delta, delta[k]);
    EXPECT_NEAR(d.parameters[i].sigma, std::sqrt(C(k, k)), 1e-15);
  }
}

TEST(RigDifference, IsTheSameBothWays) {
  const RigEstimate a = calibrated(1), b = calibrated(2);
  EXPECT_NEAR(of(a, b).mahalanobis2, of(b, a).mahalanobis2, 1e-3 * of(a, b).mahalanobis2);
}

TEST(RigDifference, ComparesNestedModelsByWhatTheyShare) {
  const RigEstimate a = calibrated(1), b = calibrated(1, OpenCv4{});
  const RigDifference d = of(a, b);
  EXPECT_EQ(d.parameters.size(), 16u);
  EXPECT_EQ(d.dof, 16);
  EXPECT_EQ(d.only_in_b, (std::vector<std::string>{"left.k2", "left.p1", "left.p2", "right.k2",
                                                   "right.p1", "right.p2"}));
  EXPECT_EQ(d.parameters.back().name, "right.tz_m");
  EXPECT_EQ(d.parameters.back().b, b.rig.T_camera_first[1].t.z());
}

TEST(RigDifference, DoesNotTakeAFisheyesCoefficientsForThoseOfAnotherModel) {
  const RigEstimate a = calibrated(1);
  RigEstimate b;
  b.rig = test::stereo_rig(Fisheye4{});
  const auto names = parameter_names(b.rig);
  const auto n = static_cast<Eigen::Index>(names.size());
  b.covariance = {CovarianceKind::prior, names, 1e-6 * Eigen::MatrixXd::Identity(n, n)};
  const RigDifference d = of(a, b);
  EXPECT_EQ(d.parameters.size(), 14u);
  EXPECT_EQ(d.only_in_a, (std::vector<std::string>{"left.k1", "right.k1"}));
  EXPECT_EQ(d.only_in_b.size(), 8u);
}

TEST(RigDifference, HoldsApartWhatIsHeldAtDifferentValues) {
  RigEstimate a = calibrated(1), b = a;
  for (RigEstimate* rig : {&a, &b}) {
    rig->covariance->matrix.row(1).setZero();
    rig->covariance->matrix.col(1).setZero();
  }
  EXPECT_EQ(of(a, b).dof, 15);
  EXPECT_EQ(of(a, b).p_value, 1);
  EXPECT_TRUE(of(a, b).parameters[1].held);

  b.rig.cameras[0].parameters[1] += 0.001;
  const RigDifference d = of(a, b);
  EXPECT_TRUE(std::isinf(d.mahalanobis2));
  EXPECT_EQ(d.p_value, 0);
  EXPECT_TRUE(says(d.fixed_at_different_values, "left.ax is fixed at"));

  // held in one alone is no contradiction: the other's variance decides
  b.covariance->matrix(1, 1) = 1e-6;
  EXPECT_EQ(of(a, b).dof, 16);
  EXPECT_NEAR(of(a, b).mahalanobis2, 1, 1e-4);
}

TEST(RigDifference, ComparesTheRestOfARotationThatBothHoldInPart) {
  const auto calibrated_with = [](std::uint64_t seed, double wy_rad) {
    const auto board = simulate_board(test::stereo_rig(), {}, {.seed = seed, .frames = 12});
    return calibrate(
        board.observations,
        {.pixel_sigma_px = 0.2, .held = {{"right.wy_rad", wy_rad}}, .white_noise = true});
  };
  const RigEstimate a = calibrated_with(1, -0.02), b = calibrated_with(2, -0.02);
  const RigDifference d = of(a, b);
  EXPECT_EQ(d.dof, 15);
  EXPECT_TRUE(d.parameters[11].held);
  EXPECT_FALSE(d.parameters[10].held);
  EXPECT_TRUE(d.fixed_at_different_values.empty());
  EXPECT_GT(d.p_value, 1e-3);
  EXPECT_TRUE(says(of(a, calibrated_with(2, -0.0201)).fixed_at_different_values,
                   "right.wy_rad is fixed at"));
}

TEST(RigDifference, NamesADirectionThatNeitherGivesAVariance) {
  RigEstimate a = calibrated(1), b = a;
  const auto n = a.covariance->matrix.rows();
  // left.ox_px and right.ox_px known only in their sum
  Eigen::VectorXd both = Eigen::VectorXd::Zero(n);
  both[2] = both[7] = 1;
  for (RigEstimate* rig : {&a, &b}) rig->covariance->matrix = both * both.transpose();
  b.rig.cameras[0].parameters[2] += 2;
  b.rig.cameras[1].parameters[2] += 2;
  EXPECT_EQ(of(a, b).dof, 1);
  EXPECT_NEAR(of(a, b).mahalanobis2, 2, 1e-9);  // 2² / (1 + 1)
  b.rig.cameras[1].parameters[2] -= 1;
  EXPECT_TRUE(std::isinf(of(a, b).mahalanobis2));
  EXPECT_TRUE(says(of(a, b).fixed_at_different_values, "without variance"))
      << of(a, b).fixed_at_different_values.size();
}

TEST(RigDifference, RefusesOtherCameras) {
  const Rig a = test::stereo_rig();
  const auto error_output = [&](const Rig& b) {
    return test::error_message([&] { check_same_cameras(a, b, "b.json"); });
  };
  Rig b = a;
  b.cameras[1].size_px = {1280, 960};
  EXPECT_EQ(
      error_output(b),
      "b.json: its camera \"right\" has images of 1280x960 and that of the first rig 640x480; "
      "calibrate both at one image size");
  b.cameras[1].name = "up";
  EXPECT_NE(error_output(b).find("its camera 2 is \"up\" and that of the first rig \"right\""),
            std::string::npos);
  b.cameras.resize(1);
  b.T_camera_first.resize(1);
  EXPECT_NE(error_output(b).find("it has 1 camera and the first rig 2"), std::string::npos);
}

TEST(RigDifference, RefusesACovarianceOfOtherParameters) {
  RigEstimate a = calibrated(1);
  Covariance wrong = *a.covariance;
  wrong.names[0] = "left.g";
  EXPECT_NE(test::error_message([&] {
              rig_difference(a.rig, wrong, a.rig, *a.covariance);
            }).find("first rig: the covariance's names are not those of the rig's parameters"),
            std::string::npos);
}

TEST(SharedViews, AreFoundByPixelsOrByImage) {
  const RigEstimate a = calibrated(1), other = calibrated(2);
  const int all = static_cast<int>(a.evidence->observations.views.size());
  EXPECT_EQ(shared_views(*a.evidence, a.rig, *a.evidence, a.rig), all);
  EXPECT_EQ(shared_views(*a.evidence, a.rig, *other.evidence, other.rig), 0);

  // found again by another detector: a little elsewhere, the image's name the same
  RigEstimate named = a, again = a;
  named.evidence->observations.views[0].image = "left01.png";
  BoardView& view = again.evidence->observations.views[0];
  view.image = "left01.png";
  for (auto& pixel : view.pixels_px) pixel.x() += 0.1;
  EXPECT_EQ(shared_views(*named.evidence, a.rig, *again.evidence, a.rig), all);
  view.ids.pop_back();  // one corner less
  view.pixels_px.pop_back();
  EXPECT_EQ(shared_views(*named.evidence, a.rig, *again.evidence, a.rig), all);
  // of another session, an image of the same name shows the board elsewhere
  for (auto& pixel : view.pixels_px) pixel.x() += 30;
  EXPECT_EQ(shared_views(*named.evidence, a.rig, *again.evidence, a.rig), all - 1);
}

}  // namespace
}  // namespace vernier
