// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "calib/board_warp.h"
#include "calib/calibrate.h"
#include "calib/combine.h"
#include "calib/simulated_board.h"
#include "calib/simulated_pairs.h"
#include "tests/support/bent_board.h"
#include "tests/support/pair_priors.h"
#include "tests/support/scenes.h"

namespace vernier {
namespace {

double in_sigma(const Rig& a, const Rig& b, const Eigen::MatrixXd& covariance) {
  return difference(a, b).cwiseQuotient(covariance.diagonal().cwiseSqrt()).cwiseAbs().maxCoeff();
}

/// Largest relative difference of standard deviations.
double sd_difference(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  return (A.diagonal().cwiseQuotient(B.diagonal()).cwiseSqrt().array() - 1).abs().maxCoeff();
}

TEST(CombineEvidence, ABentBoardStaysAnUnknown) {
  const auto board = simulate_board(test::stereo_rig(), {}, 31, 0, {.frames = 12});
  const BoardObservations views = test::bent(board, {1.5e-3, -0.8e-3});
  const RigEstimate bent =
      calibrate(views, {.pixel_sigma_px = 0.2, .warp = BoardWarp::free, .check_input = false});
  const JointCalibration one = combine({{"bent", bent, {}}}).joint;
  EXPECT_LT(in_sigma(one.estimate.rig, bent.rig, *bent.covariance_mvb), 1e-5);
  EXPECT_LT(sd_difference(*one.estimate.covariance_mvb, *bent.covariance_mvb), 1e-5);
  EXPECT_LT((one.estimate.evidence->warp_m - bent.evidence->warp_m).norm(), 1e-8);
  EXPECT_EQ(one.estimate.calibration->dof, bent.calibration->dof);
  // Two sets of views of it are one board: as all of them at once.
  BoardObservations first = views, second = views;
  const auto in_first = [](const BoardView& view) { return view.frame < 6; };
  std::erase_if(first.views, [&](const BoardView& view) { return !in_first(view); });
  std::erase_if(second.views, in_first);
  const CalibrationOptions how{
      .pixel_sigma_px = 0.2, .warp = BoardWarp::free, .check_input = false};
  const JointCalibration two =
      combine({{"first", calibrate(first, how), {}}, {"second", calibrate(second, how), {}}},
              {.keep_disagreeing = true})
          .joint;
  EXPECT_LT(in_sigma(two.estimate.rig, bent.rig, *bent.covariance_mvb), 1e-5);
  EXPECT_LT(sd_difference(*two.estimate.covariance_mvb, *bent.covariance_mvb), 1e-5);
}

TEST(CombineEvidence, BendsOfDifferentBoardsAreSaidToBeTakenAsKnown) {
  const auto board = simulate_board(test::stereo_rig(), {}, 32, 0, {.frames = 8});
  const auto other = simulate_board(test::stereo_rig(), {7, 5, 0.04}, 33, 0, {.frames = 8});
  const CalibrationOptions how{.pixel_sigma_px = 0.2, .check_input = false};
  CalibrationOptions warped = how;
  warped.warp = BoardWarp::free;
  const JointCalibration both =
      combine({{"bent", calibrate(test::bent(board, {1e-3, 1e-3}), warped), {}},
               {"other", calibrate(other.observations, how), {}}},
              {.keep_disagreeing = true})
          .joint;
  const std::vector<std::string>& said = both.estimate.calibration->warnings;
  EXPECT_TRUE(std::any_of(said.begin(), said.end(), [](const std::string& warning) {
    return warning.find("different boards") != std::string::npos;
  }));
}

TEST(CombineEvidence, ABoardKeepsThePriorItWasCalibratedWith) {
  const Rig truth = test::stereo_rig();
  const auto board = simulate_board(truth, {}, 34, 0, {.frames = 6});
  CalibrationOptions how{.pixel_sigma_px = 0.2, .check_input = false};
  how.prior = test::datasheet(truth, 34, 0, 0.05);
  how.known = {{"left.f_px", truth.cameras[0].f_px(), 0.5}};
  const RigEstimate with = calibrate(board.observations, how);
  ASSERT_EQ(with.evidence->priors.size(), 2u);
  const JointCalibration one = combine({{"with", with, {}}}).joint;
  EXPECT_LT(in_sigma(one.estimate.rig, with.rig, *with.covariance_mvb), 1e-5);
  EXPECT_LT(sd_difference(*one.estimate.covariance_mvb, *with.covariance_mvb), 1e-5);
}

TEST(CombineEvidence, NewPriorsOfAnInputAreCompared) {
  const Rig truth = test::stereo_rig();
  const PairObservations a = simulate_pairs(truth, 35), b = simulate_pairs(truth, 36);
  const JointOptions noise{.pair_sigma_scale = 1};
  const RigKnowledge known = test::datasheet(truth, 35, 0);
  RigKnowledge elsewhere = known;  // of another rig: the baseline a tenth longer
  elsewhere.rig.T_camera_first[1].t *= 1.1;
  elsewhere.covariance.matrix *= 0.01;
  const RigEstimate first = calibrate_from_pairs(a, known, noise).estimate;
  const RigEstimate second = calibrate_from_pairs(b, elsewhere, noise).estimate;
  const Combination both =
      combine({{"first", first, {}}, {"second", second, {}}}, {.joint = noise});
  EXPECT_LT(both.inputs[1].agreement.p_value, 1e-4);
  EXPECT_FALSE(both.inputs[1].used);
}

TEST(CombineEvidence, FewPairsAnImageAndAnEstimatedScaleKeepTheOrderIndifferent) {
  const Rig truth = test::stereo_rig(OpenCv4{});
  RigKnowledge known{truth, {CovarianceKind::prior, parameter_names(truth), {}}};
  Eigen::VectorXd sd(22);
  sd << 10, 0.002, 8, 8, 0.02, 0.02, 0.001, 0.001, 10, 0.002, 8, 8, 0.02, 0.02, 0.001, 0.001, 0.01,
      0.01, 0.01, 0.002, 0.002, 0.002;
  known.covariance.matrix = sd.cwiseAbs2().asDiagonal();
  RigEstimate prior;
  prior.rig = known.rig;
  prior.covariance = known.covariance;
  const auto batch = [&](int seed) {
    return CombineInput{"batch",
                        {},
                        simulate_pairs(truth, seed, 0,
                                       {.image_pairs = 6,
                                        .pairs_per_image = 21,
                                        .pixel_sigma_px = 0.25,
                                        .wrong_share = 0.03})};
  };
  const CombineInput datasheet{"datasheet", prior, {}};
  const RigEstimate one = combine({datasheet, batch(37), batch(38)}).joint.estimate;
  const RigEstimate two = combine({datasheet, batch(38), batch(37)}).joint.estimate;
  EXPECT_LT(in_sigma(one.rig, two.rig, *one.covariance_mvb), 3e-6);
  EXPECT_EQ(one.calibration->pair_outliers.size(), two.calibration->pair_outliers.size());
}

TEST(CombineEvidence, AgreementWithHeldParametersIsOfThePriorGivenThem) {
  // C_0 correlates the focal lengths; holding one at its true value moves the other's mean.
  const Rig truth = test::stereo_rig();
  RigKnowledge known = test::datasheet(truth, 39, 0);
  Eigen::MatrixXd& C = known.covariance.matrix;
  C(0, 5) = C(5, 0) = 0.9 * std::sqrt(C(0, 0) * C(5, 5));
  known.rig = truth;
  const PairObservations pairs = simulate_pairs(truth, 39);
  const JointOptions fair{.held = {{"left.f_px", truth.cameras[0].f_px()}}, .pair_sigma_scale = 1};
  const PriorAgreement right =
      agreement_with(known, calibrate_from_pairs(pairs, known, fair).estimate);
  EXPECT_GT(right.dof, 3);
  EXPECT_GT(right.p_value, 1e-3);
  RigKnowledge wrong = known;
  wrong.covariance.matrix *= 1e-4;
  Eigen::VectorXd off = Eigen::VectorXd::Zero(16);
  off[12] = 5e-3;
  wrong.rig = retract(truth, off);
  const PriorAgreement contradicted =
      agreement_with(wrong, calibrate_from_pairs(pairs, wrong, fair).estimate);
  EXPECT_LT(contradicted.p_value, 1e-4);
}

TEST(CombineEvidence, ABatchLeftOutDriftsByItsOwnNoiseOnly) {
  // Directions that pairs do not see are the prior's in both, so their difference is narrow.
  const Rig truth = test::stereo_rig();
  Eigen::VectorXd turn = Eigen::VectorXd::Zero(16);
  turn[12] = 2e-3;
  const RigKnowledge known = test::datasheet(truth, 41, 0);
  RigEstimate prior;
  prior.rig = known.rig;
  prior.covariance = known.covariance;
  const std::vector<CombineInput> inputs{{"datasheet", prior, {}},
                                         {"before", {}, simulate_pairs(truth, 41)},
                                         {"after", {}, simulate_pairs(retract(truth, turn), 42)}};
  const CombineOptions options{.joint = {.pair_sigma_scale = 1, .white_noise = true}};
  const Combination combined = combine(inputs, options);
  ASSERT_FALSE(combined.inputs[2].used);
  const MonitoredBatch& after = monitor(inputs, combined, options).at(1);
  const int baseline = 13;
  const double sd = std::sqrt(known.covariance.matrix(baseline, baseline));
  EXPECT_LT(after.sigma[baseline], 0.2 * sd);
  EXPECT_LT(std::abs(after.offset[baseline]), 5 * after.sigma[baseline] + 1e-3 * sd);
  EXPECT_NEAR(after.offset[12], 2e-3, 5 * after.sigma[12]);
}

}  // namespace
}  // namespace vernier
