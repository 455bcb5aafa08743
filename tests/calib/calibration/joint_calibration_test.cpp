// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/joint_calibration.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <limits>

#include "calib/base/atomic_file.h"
#include "calib/calibrate.h"
#include "calib/calibration/information_filter.h"
#include "calib/camera.h"
#include "calib/combine.h"
#include "calib/estimate/simulated_pairs.h"
#include "calib/formats/pairs_file.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "calib/rig_prior.h"
#include "calib/simulated_board.h"
#include "calib/solver/epipolar_system.h"
#include "calib/solver/packed_pairs.h"
#include "calib/solver/resolve_pairs.h"
#include "calib/validation/rig_drift.h"
#include "tests/support/dense_oracles.h"
#include "tests/support/error_message.h"
#include "tests/support/jet_oracles.h"
#include "tests/support/pair_priors.h"
#include "tests/support/rig_distance.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

using test::datasheet;
using test::error_message;

CombineInput as_input(const GaussianRigPrior& known) {
  RigEstimate estimate;
  estimate.rig = known.rig;
  estimate.covariance = known.covariance;
  return {"datasheet", estimate, {}};
}

Eigen::Vector4d exchanged(const Eigen::Vector4d& y) { return {y[2], y[3], y[0], y[1]}; }

TEST(JointCalibration, CeresAndTheResolverAgreeWithJetsOnPairs) {
  const Rig truth = test::stereo_rig();
  const PairObservations pairs = simulate_pairs(truth, 51);
  const GaussianRigPrior known = datasheet(truth, 51, 0);
  const JointCalibration ours =
      calibrate_from_pairs(pairs, known, {.pair_sigma_scale = 1, .reject_outliers = false});
  const RigPrior prior = rig_prior(known.rig, known);
  const EpipolarMinimum again = PairResolver(pairs).minimise(known.rig, {.priors = {prior}});
  const Rig jets = test::solve_by_jets(pairs, prior, known.rig);
  const Eigen::MatrixXd& C = *ours.estimate.covariance_mvb;
  EXPECT_LT(test::worst_sigmas(ours.estimate.rig, again.rig, C), 1e-6);
  EXPECT_LT(test::worst_sigmas(ours.estimate.rig, jets, C), 1e-6);
  const EpipolarSystem system =
      epipolar_system(PackedPairs(pairs), ours.estimate.rig, {.priors = {prior}},
                      Eigen::MatrixXd::Identity(16, 16));
  EXPECT_TRUE((C * system.information).isApprox(Eigen::MatrixXd::Identity(16, 16), 1e-5));
}

TEST(JointCalibration, SampsonIsFullBundleAdjustmentToATenThousandthOfASigma) {
  Rig truth = test::stereo_rig();
  const PairObservations pairs = simulate_pairs(truth, 52);
  const RigPrior prior = rig_prior(truth, datasheet(truth, 52, 0));
  // The rotation of the prior is the tangent's origin in both.
  const EpipolarMinimum sampson = PairResolver(pairs).minimise(prior.mean, {.priors = {prior}});
  const Rig bundle = test::bundle_adjusted(pairs, prior, prior.mean);
  const EpipolarSystem system = epipolar_system(
      PackedPairs(pairs), sampson.rig, {.priors = {prior}}, Eigen::MatrixXd::Identity(16, 16));
  const Eigen::MatrixXd C = test::inverse(system.information);
  const double distance = test::worst_sigmas(sampson.rig, bundle, C);
  RecordProperty("sampson_against_bundle_sigma", std::to_string(distance));
  EXPECT_LT(distance, 2e-4);
}

TEST(Combine, BatchesInAnyOrderAreTheBatchSolution) {
  const Rig truth = test::stereo_rig();
  const GaussianRigPrior known = datasheet(truth, 53, 0, 0.5);
  std::vector<CombineInput> batches;
  PairObservations all;
  for (int b = 0; b < 8; ++b) {
    const PairObservations pairs = simulate_pairs(
        truth, 53 + b, 0, {.image_pairs = 5, .pairs_per_image = 50, .wrong_share = 0.02});
    append(all, pairs);
    batches.push_back({"batch " + std::to_string(b), {}, pairs});
  }
  const CombineOptions options{.joint = {.pair_sigma_scale = 1}};
  const JointCalibration at_once = calibrate_from_pairs(all, known, options.joint);
  const Eigen::MatrixXd& C = *at_once.estimate.covariance_mvb;
  double worst = 0;
  for (int order = 0; order < 3; ++order) {
    std::vector<CombineInput> inputs{as_input(known)};
    inputs.insert(inputs.end(), batches.begin(), batches.end());
    const Combination combined = combine(inputs, options);
    for (const CombinedInput& input : combined.inputs) EXPECT_TRUE(input.used) << input.name;
    worst =
        std::max(worst, test::worst_sigmas(combined.joint.estimate.rig, at_once.estimate.rig, C));
    std::rotate(batches.begin(), batches.begin() + 3, batches.end());
    std::swap(batches[0], batches[5]);
  }
  RecordProperty("worst_sigma", std::to_string(worst));
  EXPECT_LT(worst, 1e-6);
}

TEST(Combine, TheInformationFilterSaysHowFarItIsFromTheBatch) {
  const Rig truth = test::stereo_rig();
  std::vector<CombineInput> inputs{as_input(datasheet(truth, 61, 0))};
  for (int b = 0; b < 10; ++b) {
    inputs.push_back(
        {"batch", {}, simulate_pairs(truth, 61 + b, 0, {.image_pairs = 4, .pairs_per_image = 50})});
  }
  const CombineOptions options{.joint = {.pair_sigma_scale = 1, .reject_outliers = false}};
  const Combination batch = combine(inputs, options);
  const InformationFilterResult filtered = information_filter(inputs, batch, options);
  RecordProperty("filter_off_by_sigma", std::to_string(filtered.worst_in_sigma));
  EXPECT_GT(filtered.worst_in_sigma, 1e-3);
  EXPECT_LT(filtered.worst_in_sigma, 3);
  EXPECT_FALSE(filtered.worst_parameter.empty());
}

TEST(Combine, BoardsPairsAndDatasheetsGoThroughOneCost) {
  const Rig truth = test::stereo_rig();
  const SimulatedBoard first = simulate_board(truth, {8, 6, 0.03}, {.seed = 71});
  const SimulatedBoard second = simulate_board(truth, {7, 5, 0.04}, {.seed = 72});
  const RigEstimate a = calibrate(first.observations), b = calibrate(second.observations);
  const GaussianRigPrior known = datasheet(truth, 71, 0);
  const PairObservations pairs = simulate_pairs(truth, 73);
  const Combination combined =
      combine({{"a", a, {}}, {"b", b, {}}, {"pairs", {}, pairs}, as_input(known)},
              {.joint = {.pair_sigma_scale = 1}});
  ASSERT_EQ(combined.inputs.size(), 4u);
  for (const CombinedInput& input : combined.inputs) EXPECT_TRUE(input.used) << input.name;
  EXPECT_EQ(combined.inputs[0].kind, "board");
  EXPECT_EQ(combined.inputs[2].kind, "pairs");
  EXPECT_EQ(combined.inputs[3].kind, "prior");
  const RigEstimate& all = combined.joint.estimate;
  EXPECT_EQ(all.calibration->source, "combined");
  // Information adds up: the bound is that of the four terms at the common minimum.
  const Eigen::MatrixXd C = *all.covariance_mvb;
  for (Eigen::Index i = 0; i < 16; ++i) {
    EXPECT_LT(C(i, i), 1.02 * std::min((*a.covariance_mvb)(i, i), (*b.covariance_mvb)(i, i)));
  }
  EXPECT_LT(test::worst_sigmas(all.rig, truth, C), 5);
  // And a board alone goes through unchanged.
  const Combination one = combine({{"a", a, {}}});
  EXPECT_LT(test::worst_sigmas(one.joint.estimate.rig, a.rig, *a.covariance_mvb), 1e-6);
  EXPECT_TRUE(one.joint.estimate.covariance_mvb->isApprox(*a.covariance_mvb, 1e-6));
}

TEST(Combine, DriftIsShownWithItsBand) {
  const Rig truth = test::stereo_rig();
  Eigen::VectorXd turn = Eigen::VectorXd::Zero(16);
  turn[12] = 2e-3;
  std::vector<CombineInput> inputs{as_input(datasheet(truth, 81, 0))};
  for (int b = 0; b < 4; ++b) {
    const Rig rig = b == 3 ? retract(truth, turn) : truth;
    inputs.push_back({"batch " + std::to_string(b), {}, simulate_pairs(rig, 81 + b, 0)});
  }
  const CombineOptions options{.joint = {.pair_sigma_scale = 1}};
  const Combination combined = combine(inputs, options);
  EXPECT_TRUE(combined.inputs[3].used);
  EXPECT_FALSE(combined.inputs[4].used);
  EXPECT_LT(combined.inputs[4].agreement.p_value, 1e-6);
  const std::vector<MonitoredBatch> batches = monitor(inputs, combined);
  ASSERT_EQ(batches.size(), 4u);
  for (int b = 0; b < 3; ++b) EXPECT_LT(std::abs(batches[b].offset[12]), 5 * batches[b].sigma[12]);
  EXPECT_NEAR(batches[3].offset[12], 2e-3, 5 * batches[3].sigma[12]);
  EXPECT_GT(batches[3].offset[12], 5 * batches[3].sigma[12]);
}

TEST(JointCalibration, ARigFileKeepsPairsAndPriors) {
  const Rig truth = test::stereo_rig();
  const PairObservations pairs =
      simulate_pairs(truth, 91, 0, {.image_pairs = 4, .pairs_per_image = 60, .wrong_share = 0.05});
  const JointCalibration joint = calibrate_from_pairs(pairs, datasheet(truth, 91, 0));
  const RigEstimate read = parse_rig(format_rig(joint.estimate), "rig.json").estimate;
  ASSERT_TRUE(read.evidence);
  EXPECT_EQ(read.evidence->pairs.pixels_px, pairs.pixels_px);
  EXPECT_EQ(read.evidence->pairs.image_pairs.size(), 4u);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    EXPECT_EQ(read.evidence->pairs.sigma_of(i), pairs.sigma_of(i));
  }
  ASSERT_EQ(read.evidence->priors.size(), 1u);
  EXPECT_EQ(read.calibration->source, "pairs");
  EXPECT_EQ(read.calibration->pair_outliers.size(),
            joint.estimate.calibration->pair_outliers.size());
  EXPECT_GT(read.calibration->pair_outliers.size(), 0u);
  // What is in the file gives the same rig again.
  const Combination again = combine({{"rig.json", read, {}}});
  EXPECT_LT(test::worst_sigmas(again.joint.estimate.rig, joint.estimate.rig,
                               *joint.estimate.covariance_mvb),
            1e-6);
}

TEST(PairsFile, RoundTripIsExactAndBadLinesAreNamed) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("vernier_pairs_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const PairObservations pairs =
      simulate_pairs(test::stereo_rig(), 95, 0, {.image_pairs = 3, .pairs_per_image = 20});
  write_pairs(pairs, folder / "pairs.csv");
  const PairObservations read = read_pairs(folder / "pairs.csv");
  EXPECT_EQ(read.pixels_px, pairs.pixels_px);
  EXPECT_EQ(read.sigma_px, pairs.sigma_px);
  const std::string header = "pair,u_left_px,v_left_px,u_right_px,v_right_px,sigma_px\n";
  const auto error_output = [&](const std::string& text) {
    write_atomically(folder / "bad.csv", text);
    const std::string said = error_message([&] { read_pairs(folder / "bad.csv"); });
    return said.substr(std::min(said.size(), said.find("bad.csv")));
  };
  EXPECT_EQ(error_output("u,v\n").substr(0, 41), "bad.csv:1: it has no header of a pairs fi");
  EXPECT_EQ(error_output(header), "bad.csv: it contains no pair; match at least one corner");
  EXPECT_EQ(error_output(header + "0,1,2,3,4,0.3\n0,1,2,3,0.3\n").substr(0, 44),
            "bad.csv:3: 5 fields where 6 are expected; a ");
  EXPECT_EQ(error_output(header + "0,1,nan,3,4,0.3\n"),
            "bad.csv:2: a pixel coordinate is not finite; remove the line");
  EXPECT_EQ(error_output(header + "0,1,2,3,4,0\n"),
            "bad.csv:2: sigma_px is 0; give a standard deviation above 0 and below a million");
  EXPECT_EQ(error_output(header + "0,1,2,3,4,1\n1,1,2,3,4,1\n0,1,2,3,5,1\n"),
            "bad.csv:4: image pair 0 appears a second time; keep its lines together");
  std::filesystem::remove_all(folder);
}

class BadPairs : public testing::Test {
 protected:
  std::string said(const PairObservations& pairs) const {
    return error_message([&] { calibrate_from_pairs(pairs, known_, {.place = "p.csv"}); });
  }
  Rig truth_ = test::stereo_rig();
  GaussianRigPrior known_ = datasheet(truth_, 96, 0);
  PairObservations pairs_ = simulate_pairs(truth_, 96);
};

TEST_F(BadPairs, AreNamed) {
  EXPECT_EQ(said(pairs_), "");
  PairObservations bad = pairs_;
  bad.pixels_px[6][1] = std::nan("");
  EXPECT_EQ(said(bad), "p.csv:8: a pixel coordinate is not finite; remove the line");
  bad = pairs_;
  bad.pixels_px[6][2] = 700;
  EXPECT_NE(said(bad).find("lies outside the right image of 640 x 480 pixels"), std::string::npos);
  bad = pairs_;
  bad.pixels_px[40] = bad.pixels_px[7];
  EXPECT_EQ(said(bad), "p.csv:42: it repeats line 9; give every match once");
  bad = simulate_pairs(truth_, 96, 0, {.image_pairs = 1, .pairs_per_image = 12});
  EXPECT_EQ(said(bad),
            "p.csv: 12 pairs for 16 free parameters; match more corners, or fix parameters");
  bad = pairs_;
  for (Eigen::Vector4d& y : bad.pixels_px) y = exchanged(y);
  EXPECT_NE(said(bad).find("left and right are swapped"), std::string::npos) << said(bad);
  bad = pairs_;
  bad.sigma_px = {0};
  EXPECT_NE(said(bad).find("p.csv:2: its noise of 0 px is invalid"), std::string::npos)
      << said(bad);
}

TEST_F(BadPairs, SoAreOptionsThatAreNoNumbers) {
  for (const double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    const std::string scale =
        error_message([&] { calibrate_from_pairs(pairs_, known_, {.pair_sigma_scale = bad}); });
    EXPECT_EQ(scale.substr(0, 47), "pair_sigma_scale: it is not a number from 0 on;") << scale;
    CombineOptions options;
    options.min_p = bad;
    const std::string p = error_message([&] {
      combine({as_input(known_), {"pairs", {}, pairs_}}, options);
    });
    EXPECT_EQ(p.substr(0, 38), "min_p: it is not a number from 0 to 1;") << p;
  }
}

TEST_F(BadPairs, SomeSwappedImagePairsAreNamed) {
  PairObservations bad = pairs_;
  for (std::size_t i = 0; i < 100; ++i) {  // of image pair 3
    Eigen::Vector4d& y = bad.pixels_px[300 + i];
    y = exchanged(y);
  }
  EXPECT_NE(said(bad).find("swapped in image pairs 3:"), std::string::npos) << said(bad);
}

TEST_F(BadPairs, AFlatSceneIsADoubt) {
  const PairObservations flat = simulate_pairs(truth_, 97, 0, {.scene = SimulatedScene::plane});
  const JointCalibration joint = calibrate_from_pairs(flat, known_);
  ASSERT_EQ(joint.estimate.calibration->trust_warnings.size(), 1u);
  EXPECT_NE(joint.estimate.calibration->trust_warnings[0].find("lie on one plane"),
            std::string::npos);
  const JointCalibration deep = calibrate_from_pairs(pairs_, known_);
  EXPECT_TRUE(deep.estimate.calibration->trust_warnings.empty());
  EXPECT_LT(joint.observability->from_data, deep.observability->from_data);
}

TEST_F(BadPairs, SoAreBadPriors) {
  GaussianRigPrior bad = known_;
  bad.covariance.matrix(0, 5) = bad.covariance.matrix(5, 0) = 150;  // of variances of 100
  const std::string indefinite =
      error_message([&] { calibrate_from_pairs(pairs_, bad, {.place = "p.csv"}); });
  EXPECT_NE(indefinite.find("not positive semi-definite"), std::string::npos) << indefinite;
  EXPECT_NE(indefinite.find("left focal length"), std::string::npos) << indefinite;
  bad = known_;
  bad.covariance.matrix(0, 5) = bad.covariance.matrix(5, 0) = 100;
  const std::string singular =
      error_message([&] { calibrate_from_pairs(pairs_, bad, {.place = "p.csv"}); });
  EXPECT_NE(singular.find("singular"), std::string::npos) << singular;
}

TEST_F(BadPairs, APriorThatThePairsContradictIsADoubt) {
  GaussianRigPrior narrow = known_;
  narrow.covariance.matrix *= 1e-4;  // claims to know everything a hundred times better
  const JointCalibration joint = calibrate_from_pairs(pairs_, narrow);
  ASSERT_FALSE(joint.estimate.calibration->trust_warnings.empty());
  EXPECT_NE(
      joint.estimate.calibration->trust_warnings.back().find("pairs and prior are inconsistent"),
      std::string::npos)
      << joint.estimate.calibration->trust_warnings.back();
}

TEST_F(BadPairs, ImagePairsHoldEveryRowOnce) {
  const auto complaint = [&](const PairObservations& pairs) {
    return error_message([&] { calibrate_from_pairs(pairs, known_); });
  };
  PairObservations bad = pairs_;
  bad.image_pairs.back().count += 1;
  EXPECT_NE(complaint(bad).find("build them with add_pair"), std::string::npos);
  EXPECT_NE(error_message([&] { selected(bad, std::vector<bool>(bad.size(), true)); }), "");
  bad.image_pairs.pop_back();
  EXPECT_NE(complaint(bad).find("rows are of no image pair"), std::string::npos);
  bad = pairs_;
  bad.sigma_px.resize(2, 1);
  EXPECT_NE(complaint(bad).find("pairs: 2 values of noise for"), std::string::npos);
  EXPECT_EQ(error_message([&] { selected(pairs_, {true}); }),
            "pairs: 1 flags for " + std::to_string(pairs_.size()) + " rows; give one per row");
}

}  // namespace
}  // namespace vernier
