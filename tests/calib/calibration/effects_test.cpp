// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/effects.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "calib/calibrate.h"
#include "calib/calibration/combine_evidence.h"
#include "calib/calibration/solve_again.h"
#include "calib/combine.h"
#include "calib/error.h"
#include "calib/noise/corner_covariance.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/frame_rows.h"
#include "calib/rig.h"
#include "calib/rig_and_boards.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "calib/uncertainty/joint_information.h"
#include "tests/support/bent_board.h"
#include "tests/support/dense_oracles.h"
#include "tests/support/error_message.h"
#include "tests/support/noisy_board.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

constexpr CornerNoise hand_held{.white_px = 0.05,
                                .field_px = 0.03,
                                .field_length_m = 0.06,
                                .motion_rad = 4e-3,
                                .motion_m = 1e-3,
                                .shape_plane_m = 5e-5,
                                .shape_height_m = 3e-4};

BoardObservations corners(const CornerNoise& noise, int frames = 10) {
  return test::noisy_board(test::stereo_rig(), {5, 4, 0.03}, {.seed = 8101, .frames = frames},
                           noise)
      .board.observations;
}

const RigEstimate& with_effects() {
  static const RigEstimate estimate = calibrate(
      corners(hand_held),
      {.reject_outliers = false, .check_input = false, .board_shape = true, .motion = true});
  return estimate;
}

RigEstimate found_in(const BoardObservations& observations,
                     CalibrationOptions& options,
                     EffectsTest& test) {
  return with_found_effects(calibrate(observations, options), observations, options, test);
}

TEST(Effects, AreFoundWhereTheyAre) {
  CalibrationOptions options{.reject_outliers = false, .check_input = false};
  EffectsTest test;
  const RigEstimate found = found_in(corners(hand_held), options, test);
  EXPECT_TRUE(options.board_shape && options.motion);
  EXPECT_TRUE(test.has_shape() && test.has_motion());
  EXPECT_EQ(parameters(found.rig), parameters(with_effects().rig));
  ASSERT_TRUE(found.calibration->effects);
}

TEST(Effects, AreLeftOutWhereTheyAreNot) {
  const BoardObservations white = corners({.white_px = 0.1});
  CalibrationOptions options{.reject_outliers = false, .check_input = false};
  EffectsTest test;
  const RigEstimate found = found_in(white, options, test);
  EXPECT_FALSE(options.board_shape || options.motion);
  EXPECT_TRUE(test.shape && test.motion && test.not_tested.empty());
  EXPECT_FALSE(found.calibration->effects);
  EXPECT_EQ(parameters(found.rig),
            parameters(calibrate(white, {.reject_outliers = false, .check_input = false}).rig));
}

TEST(Effects, OfABoardThatOnlyMovesAreItsMotion) {
  CornerNoise noise = hand_held;
  noise.shape_plane_m = noise.shape_height_m = 0;
  CalibrationOptions options{.reject_outliers = false, .check_input = false};
  EffectsTest test;
  const RigEstimate found = found_in(corners(noise), options, test);
  EXPECT_TRUE(options.motion);
  EXPECT_FALSE(options.board_shape);
  EXPECT_TRUE(found.calibration->effects->shape_m.empty());
}

/// Of four sets of a board that moves so: those in which motion is found, and found to be along the
/// baseline.
std::pair<int, int> found_motions(const CornerNoise& noise) {
  int motions = 0, along = 0;
  for (std::uint32_t t = 0; t < 4; ++t) {
    const auto drawn =
        test::noisy_board(test::stereo_rig(), {5, 4, 0.03},
                          {.seed = 8106, .trial = t, .poses = t, .frames = 14}, noise);
    const CalibrationOptions how{.reject_outliers = false, .check_input = false};
    const EffectsTest test = test_effects(calibrate(drawn.board.observations, how), how);
    motions += test.has_motion();
    along += test.has_motion() && test.along_baseline;
  }
  return {motions, along};
}

// A hand that moves along the baseline is found although the other directions stand still, and its
// motion told from one that is alike in all directions, which is taken for it in 5 % of sets (three
// or more of four: 0.05 %).
TEST(Effects, OfAMotionAlongTheBaselineAreFound) {
  const auto [motions, along] =
      found_motions({.white_px = 0.1, .motion_m = 2e-4, .motion_baseline_m = 2e-3});
  EXPECT_EQ(motions, 4);
  EXPECT_GE(along, 3);
  const auto [isotropic, taken] = found_motions({.white_px = 0.1, .motion_m = 1.5e-3});
  EXPECT_EQ(isotropic, 4);
  EXPECT_LE(taken, 2);
}

TEST(Effects, AreSolvedAgainWithAMotionAlongTheBaseline) {
  const CornerNoise noise{.white_px = 0.1, .motion_m = 1e-4, .motion_baseline_m = 8e-4};
  const auto drawn = test::noisy_board(test::stereo_rig(), {}, {.seed = 8107, .frames = 12}, noise);
  const RigEstimate found = calibrate(
      drawn.board.observations,
      {.reject_outliers = false, .check_input = false, .motion = true, .baseline_motion = true});
  const CalibrationEffects& effects = *found.calibration->effects;
  EXPECT_GT(effects.motion_baseline_m, 2 * effects.motion_m);
  const RigEstimate read = parse_rig(format_rig(found), "rig.json").estimate;
  const RigEstimate again =
      calibrate(read.evidence->observations, options_to_solve_again(with_default_names(read)));
  EXPECT_EQ(again.calibration->effects->motion_baseline_m, effects.motion_baseline_m);
  EXPECT_EQ(parameters(again.rig), parameters(found.rig));
}

TEST(Effects, AreNotLookedForWhereTheyHaveNoPlace) {
  const auto reason = [](CalibrationOptions options, int frames) {
    options.check_input = options.reject_outliers = false;
    EffectsTest test;
    found_in(corners({.white_px = 0.1}, frames), options, test);
    EXPECT_FALSE(options.board_shape || options.motion);
    EXPECT_FALSE(test.shape || test.motion);
    return test.not_tested;
  };
  EXPECT_EQ(reason({.warp = BoardWarp::free}, 10), "the board's warp is estimated");
  EXPECT_EQ(reason({.pixel_sigma_px = 0.1}, 10), "the noise is given");
  EXPECT_EQ(reason({}, 7), "7 views; it takes 8");
  EXPECT_EQ(reason({}, 3), "3 views; it takes 4");
}

// A board that is bent by 1 mm in four or five views, of which no one would be told otherwise.
TEST(Effects, OfFewViewsAreABend) {
  for (const int frames : {4, 5}) {
    const SimulatedBoard flat =
        simulate_board(test::stereo_rig(), {}, {.seed = 8108, .frames = frames});
    const BoardObservations bent = test::bent(flat, {5e-4, 5e-4});
    EXPECT_EQ(calibrate(bent).calibration->trust_warnings, std::vector<std::string>{});
    CalibrationOptions options;
    EffectsTest test;
    const RigEstimate found = found_in(bent, options, test);
    EXPECT_TRUE(options.board_shape && !options.motion);
    EXPECT_TRUE(test.has_bend() && test.has_shape() && !test.shape);
    const std::vector<Eigen::Vector3d>& shape_m = found.calibration->effects->shape_m;
    // between the middle of a long side and a corner: 0.5 mm, to 99.9 %
    EXPECT_NEAR(shape_m[4].z() - shape_m[0].z(), 5e-4, 3e-4);
    CalibrationOptions of_flat;
    const RigEstimate usual = found_in(flat.observations, of_flat, test);
    EXPECT_FALSE(of_flat.board_shape || test.has_bend());
    EXPECT_TRUE(test.bend);
    EXPECT_FALSE(usual.calibration->effects);
  }
}

// A rig file keeps all that it takes to solve the corners again, with effects and without.
TEST(Effects, AreSolvedAgainFromARigFile) {
  RigEstimate named = with_effects();
  rename_cameras(named, {"port", "starboard"});
  const RigEstimate read = parse_rig(format_rig(named), "rig.json").estimate;
  ASSERT_TRUE(read.evidence && read.calibration->effects);
  EXPECT_EQ(read.calibration->effects->shape_m, with_effects().calibration->effects->shape_m);
  const RigEstimate again =
      calibrate(read.evidence->observations, options_to_solve_again(with_default_names(read)));
  EXPECT_EQ(parameters(again.rig), parameters(with_effects().rig));
  EXPECT_EQ(again.covariance->matrix, with_effects().covariance->matrix);
  const RigEstimate usual = without_effects(read);
  EXPECT_FALSE(usual.calibration->effects);
  EXPECT_EQ(usual.rig.cameras[1].name, "starboard");
  EXPECT_EQ(usual.covariance->names.front().substr(0, 5), "port.");
  EXPECT_EQ(
      parameters(usual.rig),
      parameters(
          calibrate(corners(hand_held), {.reject_outliers = false, .check_input = false}).rig));
  EXPECT_EQ(parameters(without_effects(usual).rig), parameters(usual.rig));
}

TEST(Effects, OfARigFileMustFitItsBoard) {
  const auto fault = [](auto change) {
    RigEstimate wrong = with_effects();
    change(*wrong.calibration->effects);
    return test::error_message([&] { parse_rig(format_rig(wrong), "rig.json"); });
  };
  EXPECT_EQ(fault([](CalibrationEffects& e) { e.shape_m.pop_back(); }),
            "rig.json: calibration.effects.shape_m: is of 19 points of a board of 20; calibrate "
            "again");
  EXPECT_EQ(fault([](CalibrationEffects& e) { e.white_px = 0; }),
            "rig.json: calibration.effects.white_px: is not above 0; calibrate again");
  EXPECT_EQ(fault([](CalibrationEffects& e) { e.shape_m.clear(); }),
            "rig.json: calibration.effects: has no shape_m; calibrate again");
}

// What is estimated is no doubt: a board that moves far, and one that is bent.
TEST(Effects, ThatAreEstimatedAreNotDoubted) {
  const CornerNoise far{.white_px = 0.05, .motion_m = 1e-3};
  const BoardObservations moved =
      test::noisy_board(test::stereo_rig(), {}, {.seed = 8102, .frames = 14}, far)
          .board.observations;
  const std::string doubt = calibrate(moved).calibration->trust_warnings.at(0);
  EXPECT_NE(doubt.find("estimate its motion with --motion"), std::string::npos) << doubt;
  const RigEstimate with_motion = calibrate(moved, {.motion = true});
  EXPECT_EQ(with_motion.calibration->trust_warnings, std::vector<std::string>{});
  const BoardObservations bent = test::bent(
      simulate_board(test::stereo_rig(), {}, {.seed = 8103, .frames = 14, .pixel_sigma_px = 0.1}),
      {3e-3, 2e-3});
  const std::string bend = calibrate(bent).calibration->trust_warnings.at(0);
  EXPECT_NE(bend.find("estimate its shape with --board-shape"), std::string::npos) << bend;
  const RigEstimate with_shape = calibrate(bent, {.board_shape = true});
  EXPECT_EQ(with_shape.calibration->trust_warnings, std::vector<std::string>{});
}

// The joint cost has no effects: it has the corners of such a calibration, so that views that two
// inputs share are found.
TEST(Effects, DoNotKeepCornersOutOfACombination) {
  const JointEvidence evidence = evidence_of({"rig.json", with_effects(), {}});
  EXPECT_TRUE(evidence.priors.empty());
  ASSERT_EQ(evidence.boards.size(), 1u);
  EXPECT_TRUE(evidence.boards[0].evidence.warp_m.isZero(0));
  EXPECT_EQ(evidence.boards[0].evidence.observations.views.size(),
            with_effects().evidence->observations.views.size());
}

// Beside a prior the degrees of freedom are no whole number, and the noise is estimated all the
// same; the prior's part of the cost is that of the rig with effects.
TEST(Effects, AreSolvedAgainBesideAPrior) {
  CalibrationOptions how{.check_input = false, .board_shape = true};
  how.known = {{"left.f_px", 521, 0.5}};
  const RigEstimate with = calibrate(corners(hand_held), how);
  const RigEstimate again = calibrate(with.evidence->observations, options_to_solve_again(with));
  const Eigen::VectorXd sd = with.covariance_mvb->diagonal().cwiseSqrt();
  EXPECT_LT(difference(again.rig, with.rig).cwiseQuotient(sd).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_NEAR(with.calibration->prior_chi2, std::pow((parameters(with.rig)[0] - 521) / 0.5, 2),
              1e-9);
}

// A bent board is doubted, and no longer where the test finds its shape; a prior that the corners
// contradict is doubted with effects as without.
TEST(Effects, ResolveTheDoubtOfABentBoardAndNoOther) {
  const BoardObservations bent = test::bent(
      simulate_board(test::stereo_rig(), {}, {.seed = 8104, .frames = 12, .pixel_sigma_px = 0.1}),
      {2e-3, 2e-3});
  CalibrationOptions options;
  EffectsTest test;
  const RigEstimate found = found_in(bent, options, test);
  EXPECT_TRUE(options.board_shape);
  EXPECT_EQ(found.calibration->trust_warnings, std::vector<std::string>{});
  CalibrationOptions wrong;
  wrong.known = {{"left.f_px", 535, 0.5}};
  const BoardObservations held =
      test::noisy_board(test::stereo_rig(), {}, {.seed = 8105, .frames = 14}, hand_held)
          .board.observations;
  const RigEstimate contradicted = found_in(held, wrong, test);
  EXPECT_TRUE(contradicted.calibration->effects);
  EXPECT_FALSE(contradicted.calibration->trust_warnings.empty());
}

/// The covariance of rig and pose of one frame by the inverse of the whole normal matrix of rig,
/// warp and poses, weighted by V⁻¹, and by the chain.
TEST(Effects, OfTheBoardsGivenTheRigAreTheInverseOfAllEquations) {
  for (const bool shape : {false, true}) {
    const RigEstimate& e = with_effects();
    const CalibrationEvidence& evidence = *e.evidence;
    CalibrationEffects effects = *e.calibration->effects;
    if (!shape) effects.shape_m.clear();
    const BoardState state{e.rig, evidence.frames, evidence.T_first_board, {0, 0}};
    const double sigma = 0.1;
    const ConditionalBoardPoses poses =
        conditional_board_poses(evidence.observations, state, effects, sigma);
    BoardObservations shaped = evidence.observations;
    for (std::size_t i = 0; i < effects.shape_m.size(); ++i) {
      shaped.target_m[i] += effects.shape_m[i];
    }
    const Eigen::Index n = parameter_count(e.rig);
    const std::vector<FrameRows> rows = frame_rows(shaped, state, Eigen::MatrixXd::Identity(n, n),
                                                   shape ? BoardWarp::free : BoardWarp::known);
    const Eigen::Index shared = rows[0].by_rig.cols();
    const auto frames = static_cast<Eigen::Index>(rows.size());
    Eigen::MatrixXd N = Eigen::MatrixXd::Zero(shared + 6 * frames, shared + 6 * frames);
    for (Eigen::Index f = 0; f < frames; ++f) {
      const FrameRows& frame = rows[static_cast<std::size_t>(f)];
      Eigen::MatrixXd J = Eigen::MatrixXd::Zero(frame.residual_px.size(), N.cols());
      J.leftCols(shared) = frame.by_rig;
      J.middleCols<6>(shared + 6 * f) = frame.by_pose;
      const Eigen::MatrixXd V =
          corner_covariance(frame, noise_of(effects), evidence.observations.target_m);
      N += J.transpose() * test::inverse(V) * J;
    }
    const Eigen::VectorXd scale = N.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * N * scale.asDiagonal();
    const Eigen::MatrixXd C = scale.asDiagonal() * test::inverse(scaled) * scale.asDiagonal();
    const Eigen::MatrixXd C_rig = C.topLeftCorner(n, n);
    for (const Eigen::Index f : {Eigen::Index{0}, frames - 1}) {
      const auto& given = poses.frames[static_cast<std::size_t>(f)];
      const Eigen::MatrixXd by_rig = given.by_rig + given.by_warp * poses.warp_by_rig;
      const Eigen::MatrixXd own = given.factor * given.factor.transpose() +
                                  given.by_warp * poses.warp_factor *
                                      poses.warp_factor.transpose() * given.by_warp.transpose();
      const Eigen::Index at = shared + 6 * f;
      const Eigen::MatrixXd expected = C.block(at, at, 6, 6);
      const Eigen::MatrixXd chain = by_rig * C_rig * by_rig.transpose() + sigma * sigma * own;
      EXPECT_LT((chain - expected).norm(), 1e-7 * expected.norm()) << shape << f;
      const Eigen::MatrixXd cross = by_rig * C_rig - C.block(at, 0, 6, n);
      EXPECT_LT(cross.norm(), 1e-7 * C.block(at, 0, 6, n).norm()) << shape << f;
    }
  }
}

}  // namespace
}  // namespace vernier
