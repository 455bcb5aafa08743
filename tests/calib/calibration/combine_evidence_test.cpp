// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/combine.h"
#include "calib/covariance.h"
#include "calib/data_and_prior.h"
#include "calib/estimate/simulated_pairs.h"
#include "calib/joint_calibration.h"
#include "calib/lens_models.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"
#include "calib/simulated_board.h"
#include "calib/validation/rig_drift.h"
#include "tests/support/bent_board.h"
#include "tests/support/pair_priors.h"
#include "tests/support/rig_distance.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

/// Largest relative difference of standard deviations.
double sd_difference(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  return (A.diagonal().cwiseQuotient(B.diagonal()).cwiseSqrt().array() - 1).abs().maxCoeff();
}

TEST(CombineEvidence, ABentBoardStaysAnUnknown) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 31, .frames = 12});
  const BoardObservations views = test::bent(board, {1.5e-3, -0.8e-3});
  const RigEstimate bent =
      calibrate(views, {.pixel_sigma_px = 0.2, .warp = BoardWarp::free, .check_input = false});
  const JointCalibration one = combine({{"bent", bent, {}}}).joint;
  EXPECT_LT(test::worst_sigmas(one.estimate.rig, bent.rig, *bent.covariance_mvb), 1e-5);
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
  EXPECT_LT(test::worst_sigmas(two.estimate.rig, bent.rig, *bent.covariance_mvb), 1e-5);
  EXPECT_LT(sd_difference(*two.estimate.covariance_mvb, *bent.covariance_mvb), 1e-5);
}

TEST(CombineEvidence, BendsOfDifferentBoardsAreSaidToBeTakenAsKnown) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 32, .frames = 8});
  const auto other = simulate_board(test::stereo_rig(), {7, 5, 0.04}, {.seed = 33, .frames = 8});
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

TEST(CombineEvidence, WhatDisagreesAndIsKeptIsDoubted) {
  const Rig rig = test::stereo_rig();
  Rig knocked = rig;
  knocked.T_camera_first[1].t.x() *= 1.05;
  const CalibrationOptions how{.pixel_sigma_px = 0.2, .check_input = false};
  const auto of = [&](const Rig& truth, std::uint64_t seed) {
    return calibrate(simulate_board(truth, {}, {.seed = seed, .frames = 8}).observations, how);
  };
  const Combination both = combine({{"before", of(rig, 34), {}}, {"after", of(knocked, 35), {}}},
                                   {.keep_disagreeing = true});
  ASSERT_TRUE(both.inputs[1].used);
  const std::vector<std::string>& said = both.joint.estimate.calibration->trust_warnings;
  EXPECT_TRUE(std::any_of(said.begin(), said.end(), [](const std::string& warning) {
    return warning.starts_with("after is inconsistent with the previous inputs") &&
           warning.find("and was kept") != std::string::npos;
  }));
}

// The same lens is warned of by `calibrate` and by calibrate_from_pairs.
TEST(CombineEvidence, ADistortionThatCannotBeInvertedIsSaid) {
  RigEstimate known;
  known.rig = test::stereo_rig(OpenCv5{});
  for (Camera& camera : known.rig.cameras) camera.parameters.tail<5>().setZero();
  const int n = parameter_count(known.rig);
  known.covariance = Covariance{CovarianceKind::prior, parameter_names(known.rig),
                                1e-6 * Eigen::MatrixXd::Identity(n, n)};
  const auto folds_said = [&] {
    const Combination combined = combine({{"datasheet", known, {}}});
    const std::vector<std::string>& said = combined.joint.estimate.calibration->warnings;
    return std::count_if(said.begin(), said.end(), [](const std::string& warning) {
      return warning.find("\"right\" cannot be inverted in 14 %") != std::string::npos;
    });
  };
  EXPECT_EQ(folds_said(), 0);
  known.rig.cameras[1].parameters[core_parameter_count] = -0.4;
  EXPECT_EQ(folds_said(), 1);
}

// What 600 corners of a scene leave open of a lens is known by the prior alone: of a wide one the
// errors are far from normal.
TEST(CombineEvidence, AWidePriorOfTheLensIsDoubted) {
  const auto doubts = [](const JointCalibration& joint) {
    const std::vector<std::string>& said = joint.estimate.calibration->trust_warnings;
    return std::count_if(said.begin(), said.end(), [](const std::string& warning) {
      return warning.find("no covariance describes its errors") != std::string::npos;
    });
  };
  const Rig truth = test::stereo_rig();
  const PairObservations pairs = simulate_pairs(truth, 61, 0, {.image_pairs = 6});
  for (const double scale : {1.0, 5.0}) {
    const GaussianRigPrior prior = test::datasheet(truth, 61, 0, scale);
    const int expected = scale > 1;
    EXPECT_EQ(doubts(calibrate_from_pairs(pairs, prior)), expected) << scale;
    RigEstimate known;
    known.rig = prior.rig;
    known.covariance = full_covariance(prior);
    EXPECT_EQ(doubts(combine({{"datasheet", known, {}}, {"pairs", {}, pairs}}).joint), expected)
        << scale;
  }
}

TEST(CombineEvidence, ABoardKeepsThePriorItWasCalibratedWith) {
  const Rig truth = test::stereo_rig();
  const auto board = simulate_board(truth, {}, {.seed = 34, .frames = 6});
  CalibrationOptions how{.pixel_sigma_px = 0.2, .check_input = false};
  how.prior = test::datasheet(truth, 34, 0, 0.05);
  how.known = {{"left.f_px", truth.cameras[0].f_px(), 0.5}};
  const RigEstimate with = calibrate(board.observations, how);
  ASSERT_EQ(with.evidence->priors.size(), 2u);
  const JointCalibration one = combine({{"with", with, {}}}).joint;
  EXPECT_LT(test::worst_sigmas(one.estimate.rig, with.rig, *with.covariance_mvb), 1e-5);
  EXPECT_LT(sd_difference(*one.estimate.covariance_mvb, *with.covariance_mvb), 1e-5);
}

TEST(CombineEvidence, NewPriorsOfAnInputAreCompared) {
  const Rig truth = test::stereo_rig();
  const PairObservations a = simulate_pairs(truth, 35), b = simulate_pairs(truth, 36);
  const JointOptions noise{.pair_sigma_scale = 1};
  const GaussianRigPrior known = test::datasheet(truth, 35, 0);
  GaussianRigPrior elsewhere = known;  // of another rig: the baseline a tenth longer
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
  GaussianRigPrior known{truth, {CovarianceKind::prior, parameter_names(truth), {}}};
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
  EXPECT_LT(test::worst_sigmas(one.rig, two.rig, *one.covariance_mvb), 3e-6);
  EXPECT_EQ(one.calibration->pair_outliers.size(), two.calibration->pair_outliers.size());
}

TEST(CombineEvidence, AgreementWithHeldParametersIsOfThePriorGivenThem) {
  // C_0 ties the right focal length to the left one within 1.4 px; its mean has both 40 px off.
  // Once the left one is held where it is, the prior's right one follows, and all agrees.
  const Rig truth = test::stereo_rig();
  GaussianRigPrior known = test::datasheet(truth, 39, 0);
  Eigen::MatrixXd& C = known.covariance.matrix;
  C(0, 5) = C(5, 0) = 0.99 * std::sqrt(C(0, 0) * C(5, 5));
  Eigen::VectorXd off = Eigen::VectorXd::Zero(16);
  off[0] = off[5] = 40;
  known.rig = retract(truth, off);
  const PairObservations pairs = simulate_pairs(truth, 39);
  JointOptions at_truth{.held = {{"left.f_px", truth.cameras[0].f_px()}}, .pair_sigma_scale = 1};
  const RigEstimate right = calibrate_from_pairs(pairs, known, at_truth).estimate;
  EXPECT_GT(consistency_with(known, right).dof, 3);
  EXPECT_GT(consistency_with(known, right).p_value, 1e-3);
  EXPECT_TRUE(right.calibration->trust_warnings.empty());
  EXPECT_EQ(right.calibration->prior_dof, 15);
  // Tied the other way round, the prior's right one falls where the pairs need it to rise.
  GaussianRigPrior apart = known;
  apart.rig = truth;
  apart.covariance.matrix(0, 5) *= -1;
  apart.covariance.matrix(5, 0) *= -1;
  at_truth.held = {{"left.f_px", truth.cameras[0].f_px() + 40}};
  EXPECT_LT(consistency_with(apart, calibrate_from_pairs(pairs, apart, at_truth).estimate).p_value,
            1e-4);
}

TEST(CombineEvidence, OneComponentOfARotationMayBeUnlisted) {
  const Rig truth = test::stereo_rig();
  GaussianRigPrior whole = test::datasheet(truth, 45, 0), part = whole;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < 16; ++i) {
    if (whole.covariance.names[static_cast<std::size_t>(i)] != "right.wx_rad") kept.push_back(i);
  }
  part.covariance.names.clear();
  for (const Eigen::Index i : kept) {
    part.covariance.names.push_back(whole.covariance.names[static_cast<std::size_t>(i)]);
  }
  part.covariance.matrix = whole.covariance.matrix(kept, kept).eval();
  part.rig.T_camera_first[1].R = truth.T_camera_first[1].R;
  const PairObservations pairs = simulate_pairs(truth, 45);
  const JointCalibration found = calibrate_from_pairs(pairs, part, {.pair_sigma_scale = 1});
  EXPECT_TRUE(found.estimate.calibration->trust_warnings.empty());
  const PriorConsistency agreement = consistency_with(part, found.estimate);
  EXPECT_GT(agreement.dof, 3);
  EXPECT_GT(agreement.p_value, 1e-4);
}

TEST(CombineEvidence, KnowledgeGivenTwiceCountsOnce) {
  const Rig truth = test::stereo_rig();
  CalibrationOptions how{.pixel_sigma_px = 0.2, .check_input = false};
  how.known = {{"left.f_px", truth.cameras[0].f_px(), 0.05}};
  const RigEstimate a =
      calibrate(simulate_board(truth, {}, {.seed = 46, .frames = 6}).observations, how);
  const RigEstimate b =
      calibrate(simulate_board(truth, {}, {.seed = 47, .frames = 6}).observations, how);
  const Combination both = combine({{"a", a, {}}, {"b", b, {}}}, {.keep_disagreeing = true});
  EXPECT_EQ(both.evidence.priors.size(), 1u);
  EXPECT_GT(std::sqrt((*both.joint.estimate.covariance_mvb)(0, 0)), 0.045);
}

TEST(CombineEvidence, ACalibrationAndWhatItWasThePriorOfCountItOnce) {
  const Rig truth = test::stereo_rig();
  const RigEstimate board =
      calibrate(simulate_board(truth, {}, {.seed = 48, .frames = 8}).observations,
                {.pixel_sigma_px = 0.2, .check_input = false});
  const PairObservations pairs = simulate_pairs(truth, 49);
  const JointOptions noise{.pair_sigma_scale = 1};
  const RigEstimate after =
      calibrate_from_pairs(pairs, gaussian_prior_of(board, "board"), noise).estimate;
  for (const bool board_first : {true, false}) {
    std::vector<CombineInput> inputs{{"board", board, {}}, {"after", after, {}}};
    if (!board_first) std::swap(inputs[0], inputs[1]);
    const Combination both = combine(inputs, {.keep_disagreeing = true, .joint = noise});
    const Combination apart = combine({{"board", board, {}}, {"pairs", {}, pairs}},
                                      {.keep_disagreeing = true, .joint = noise});
    EXPECT_TRUE(both.evidence.priors.empty());
    EXPECT_LT(
        sd_difference(*both.joint.estimate.covariance_mvb, *apart.joint.estimate.covariance_mvb),
        1e-6);
  }
}

TEST(CombineEvidence, BoardsAndPairsWithoutAPriorInAnyOrder) {
  const Rig truth = test::stereo_rig();
  const RigEstimate board =
      calibrate(simulate_board(truth, {}, {.seed = 50, .frames = 10}).observations,
                {.pixel_sigma_px = 0.2, .check_input = false});
  const SimulatedPairsOptions few{.image_pairs = 4, .pairs_per_image = 40, .wrong_share = 0.02};
  const CombineInput a{"a", {}, simulate_pairs(truth, 50, 0, few)},
      b{"b", {}, simulate_pairs(truth, 51, 0, few)};
  const RigEstimate one = combine({{"board", board, {}}, a, b}).joint.estimate;
  const RigEstimate two = combine({{"board", board, {}}, b, a}).joint.estimate;
  // where the solver stops, which differs between processors (3.2e-6 seen with AVX2)
  EXPECT_LT(test::worst_sigmas(one.rig, two.rig, *one.covariance_mvb), 1e-5);
  const RigEstimate again = combine({{"one", one, {}}}).joint.estimate;
  EXPECT_LT(test::worst_sigmas(one.rig, again.rig, *one.covariance_mvb), 1e-5);
}

TEST(CombineEvidence, ABatchLeftOutDriftsByItsOwnNoiseOnly) {
  // Directions that pairs do not see are the prior's in both, so their difference is narrow.
  const Rig truth = test::stereo_rig();
  Eigen::VectorXd turn = Eigen::VectorXd::Zero(16);
  turn[12] = 2e-3;
  const GaussianRigPrior known = test::datasheet(truth, 41, 0);
  RigEstimate prior;
  prior.rig = known.rig;
  prior.covariance = known.covariance;
  const std::vector<CombineInput> inputs{{"datasheet", prior, {}},
                                         {"before", {}, simulate_pairs(truth, 41)},
                                         {"after", {}, simulate_pairs(retract(truth, turn), 42)}};
  const Combination combined =
      combine(inputs, {.joint = {.pair_sigma_scale = 1, .white_noise = true}});
  ASSERT_FALSE(combined.inputs[2].used);
  const MonitoredBatch after = monitor(inputs, combined).at(1);
  const int baseline = 13;
  const double sd = std::sqrt(known.covariance.matrix(baseline, baseline));
  EXPECT_EQ(after.sigma[baseline], 0);
  EXPECT_LT(std::abs(after.offset[baseline]), 0.1 * sd);
  EXPECT_NEAR(after.offset[12], 2e-3, 5 * after.sigma[12]);
}

TEST(Combine, DriftIsOfTheParametersThatAreNotHeld) {
  const Rig truth = test::stereo_rig();
  Eigen::VectorXd turn = Eigen::VectorXd::Zero(16);
  turn[12] = 5e-3;
  GaussianRigPrior known = test::datasheet(truth, 43, 0, 0.3);
  constexpr int held[] = {1, 6, 13};  // aspect ratios, and the length of the baseline
  Eigen::VectorXd delta = difference(known.rig, truth);
  for (const int i : held) {
    delta[i] = 0;
    known.covariance.matrix.row(i).setZero();
    known.covariance.matrix.col(i).setZero();
  }
  RigEstimate prior;
  prior.rig = retract(truth, delta);
  prior.covariance = known.covariance;
  const std::vector<CombineInput> inputs{{"datasheet", prior, {}},
                                         {"one", {}, simulate_pairs(truth, 43)},
                                         {"two", {}, simulate_pairs(truth, 44)},
                                         {"turned", {}, simulate_pairs(retract(truth, turn), 45)}};
  const MonitoredBatch turned = monitor(inputs, combine(inputs)).at(2);
  for (const int i : held) EXPECT_EQ(turned.sigma[i], 0) << i;
  EXPECT_NEAR(turned.offset[12], 5e-3, 5 * turned.sigma[12]);
  EXPECT_LT(turned.sigma[12], 1e-3);
}

}  // namespace
}  // namespace vernier
