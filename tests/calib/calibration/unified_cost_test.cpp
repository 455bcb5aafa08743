// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Core>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/camera/model_nesting.h"
#include "calib/combine.h"
#include "calib/covariance.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "calib/rig_prior.h"
#include "calib/simulated_board.h"
#include "calib/solver/normal_equations.h"
#include "tests/support/bent_board.h"
#include "tests/support/dense_oracles.h"
#include "tests/support/error_message.h"
#include "tests/support/rig_distance.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

using test::worst_sigmas;

Eigen::Index index_of(const Rig& rig, const std::string& name) {
  const auto names = parameter_names(rig);
  return std::find(names.begin(), names.end(), name) - names.begin();
}

TEST(HeldParameters, KeepTheirValueAndHaveNoVariance) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 11});
  const RigEstimate e = calibrate(
      board.observations, {.held = {{"left.ax", 1.001}, {"right.k1", {}}, {"right.tx_m", -0.199}}});
  const Eigen::VectorXd a = parameters(e.rig);
  for (const auto& [name, value] :
       {std::pair{"left.ax", 1.001}, {"right.k1", 0.0}, {"right.tx_m", -0.199}}) {
    const Eigen::Index i = index_of(e.rig, name);
    EXPECT_EQ(a[i], value) << name;
    EXPECT_EQ(e.covariance->matrix.row(i).norm(), 0) << name;
    EXPECT_EQ(e.covariance_mvb->col(i).norm(), 0) << name;
  }
  EXPECT_EQ(e.calibration->held.size(), 3u);
}

TEST(HeldParameters, BoundIsTheInverseOfWhatIsLeftOfTheInformation) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 12});
  const RigEstimate e =
      calibrate(board.observations, {.pixel_sigma_px = 0.2, .held = {{"left.f_px", 525.0}}});
  const BoardState state{e.rig, e.evidence->frames, e.evidence->T_first_board};
  const Eigen::MatrixXd S =
      reduced_normal_equations(e.evidence->observations, state, 0.2).information;
  const auto n = S.rows() - 1;  // left.f_px is the first
  const Eigen::MatrixXd expected = test::inverse(S.bottomRightCorner(n, n));
  const Eigen::VectorXd sd = expected.diagonal().cwiseSqrt();
  const Eigen::MatrixXd off = sd.cwiseInverse().asDiagonal() *
                              (e.covariance_mvb->bottomRightCorner(n, n) - expected) *
                              sd.cwiseInverse().asDiagonal();
  EXPECT_LT(off.cwiseAbs().maxCoeff(), 1e-8);
}

TEST(HeldParameters, ARotationMayBeHeldInPart) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 13});
  const RigEstimate e = calibrate(board.observations, {.held = {{"right.wy_rad", -0.02}}});
  EXPECT_NEAR(vector_from_rotation(e.rig.T_camera_first[1].R).y(), -0.02, 1e-15);
  // Moves within the covariance leave that component of the rotation vector where it is.
  const ScaledDecomposition decomposition(*e.covariance);
  for (Eigen::Index k = 0; k < decomposition.factor().cols(); ++k) {
    const Rig moved = retract(e.rig, 1e-3 * decomposition.factor().col(k));
    EXPECT_NEAR(vector_from_rotation(moved.T_camera_first[1].R).y(), -0.02, 1e-12);
  }
}

// Written, read and taken for another calibration's prior: as good as all views at once.
TEST(HeldParameters, ARotationHeldInPartSurvivesItsFileAndIsAPrior) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 13, .frames = 40});
  BoardObservations first = board.observations, second = board.observations;
  std::erase_if(first.views, [](const BoardView& view) { return view.frame % 2 == 1; });
  std::erase_if(second.views, [](const BoardView& view) { return view.frame % 2 == 0; });
  CalibrationOptions options{
      .pixel_sigma_px = 0.2, .held = {{"right.wy_rad", -0.02}}, .white_noise = true};
  const RigEstimate a = calibrate(first, options), whole = calibrate(board.observations, options);

  const RigFile file = parse_rig(format_rig(a), "a.json");
  EXPECT_EQ(file.listed.size(), 15u);
  EXPECT_EQ(std::count(file.listed.begin(), file.listed.end(), "right.wy_rad"), 0);
  for (const auto& [read, written] :
       {std::pair{file.estimate.covariance->matrix, a.covariance->matrix},
        {*file.estimate.covariance_mvb, *a.covariance_mvb}}) {
    const Eigen::VectorXd sd = written.diagonal().cwiseSqrt();
    const Eigen::MatrixXd off = (read - written).cwiseQuotient(sd * sd.transpose());
    EXPECT_LT(off.cwiseAbs().maxCoeff(), 1e-12);
  }

  options.prior = gaussian_rig_prior(file, "a.json");
  const RigEstimate both = calibrate(second, options);
  EXPECT_EQ(both.calibration->prior_dof, 15);
  EXPECT_LT(worst_sigmas(both.rig, whole.rig, *whole.covariance_mvb), 0.05);
  const Eigen::ArrayXd ratio =
      both.covariance_mvb->diagonal().array() / whole.covariance_mvb->diagonal().array();
  EXPECT_NEAR(ratio.minCoeff(), 1, 0.02);
  EXPECT_NEAR(ratio.maxCoeff(), 1, 0.02);
  // Of the held component it says nothing where that is free.
  options.held.clear();
  EXPECT_GT(calibrate(second, options).covariance_mvb->diagonal()[11], 0);
}

TEST(HeldParameters, AreHeldInACombination) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 13, .frames = 24});
  BoardObservations first = board.observations, second = board.observations;
  std::erase_if(first.views, [](const BoardView& view) { return view.frame % 2 == 1; });
  std::erase_if(second.views, [](const BoardView& view) { return view.frame % 2 == 0; });
  const CalibrationOptions options{.pixel_sigma_px = 0.2,
                                   .held = {{"right.wy_rad", -0.02}, {"left.ax", 1.002}}};
  const RigEstimate a = calibrate(first, options), b = calibrate(second, options),
                    whole = calibrate(board.observations, options);
  const Combination both = combine({{"a.json", a, {}}, {"b.json", b, {}}});
  EXPECT_TRUE(both.inputs[1].used);
  EXPECT_EQ(both.inputs[1].agreement.dof, 14);
  EXPECT_LT(worst_sigmas(both.joint.estimate.rig, whole.rig, *whole.covariance_mvb), 1e-4);
}

TEST(HeldParameters, AreNamedWhereTheyAreWrong) {
  const auto observations = simulate_board(test::stereo_rig(), {}, {.seed = 11}).observations;
  const auto error_output = [&](const HeldParameter& held) {
    return test::error_message([&] { calibrate(observations, {.held = {held}}); });
  };
  EXPECT_NE(error_output({"left.k7", {}}).find("held parameter left.k7: the rig has no such"),
            std::string::npos);
  EXPECT_NE(error_output({"left.ay", 1.0}).find("ay is 1 by definition"), std::string::npos);
  EXPECT_NE(error_output({"left.f_px", -3.0}).find("invalid value -3"), std::string::npos);
  EXPECT_NE(test::error_message([&] {
              calibrate(observations, {.held = {{"left.ax", {}}, {"left.ax", {}}}});
            }).find("is held twice"),
            std::string::npos);
}

TEST(Prior, InformationAddsUp) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 14});
  const Rig truth = test::stereo_rig();
  const RigEstimate e = calibrate(
      board.observations,
      {.pixel_sigma_px = 0.2, .known = {{"left.f_px", 525, 0.4}, {"right.tx_m", -0.2, 1e-4}}});
  const BoardState state{e.rig, e.evidence->frames, e.evidence->T_first_board};
  Eigen::MatrixXd S = reduced_normal_equations(e.evidence->observations, state, 0.2).information;
  S(0, 0) += 1 / (0.4 * 0.4);
  const Eigen::Index tx = index_of(truth, "right.tx_m");
  S(tx, tx) += 1 / (1e-4 * 1e-4);
  EXPECT_LT((*e.covariance_mvb * S - Eigen::MatrixXd::Identity(16, 16)).cwiseAbs().maxCoeff(),
            1e-6);
  EXPECT_EQ(e.calibration->prior_dof, 2);
  EXPECT_GT(e.calibration->prior_chi2, 0);
}

TEST(Prior, WeakSaysNothingAndStrongSaysAll) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 15});
  const RigEstimate plain = calibrate(board.observations);
  const RigEstimate weak = calibrate(board.observations, {.known = {{"left.f_px", 400, 1e7}}});
  const RigEstimate strong = calibrate(board.observations, {.known = {{"left.f_px", 526, 1e-7}}});
  const RigEstimate held = calibrate(board.observations, {.held = {{"left.f_px", 526.0}}});
  EXPECT_LT(worst_sigmas(weak.rig, plain.rig, *plain.covariance_mvb), 1e-5);
  EXPECT_LT(worst_sigmas(strong.rig, held.rig, *held.covariance_mvb), 1e-5);
  EXPECT_NEAR(strong.calibration->pixel_sigma_px / held.calibration->pixel_sigma_px, 1, 1e-6);
}

// Two halves of the views, the first as the second's prior, are the whole: the unified cost's
// purpose. Exact up to the curvature of the first half's cost.
TEST(Prior, HalfTheViewsAsPriorOfTheOtherHalf) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 16, .frames = 40});
  BoardObservations first = board.observations, second = board.observations;
  std::erase_if(first.views, [](const BoardView& view) { return view.frame % 2 == 1; });
  std::erase_if(second.views, [](const BoardView& view) { return view.frame % 2 == 0; });
  const CalibrationOptions white{.pixel_sigma_px = 0.2, .white_noise = true};
  const RigEstimate a = calibrate(first, white), whole = calibrate(board.observations, white);
  CalibrationOptions with_prior = white;
  with_prior.prior = GaussianRigPrior{a.rig, *a.covariance};
  const RigEstimate both = calibrate(second, with_prior);
  EXPECT_LT(worst_sigmas(both.rig, whole.rig, *whole.covariance_mvb), 0.05);
  const Eigen::ArrayXd ratio =
      both.covariance_mvb->diagonal().array() / whole.covariance_mvb->diagonal().array();
  EXPECT_NEAR(ratio.minCoeff(), 1, 0.02);
  EXPECT_NEAR(ratio.maxCoeff(), 1, 0.02);
}

TEST(Prior, IsRefusedWithItsDirection) {
  const auto observations = simulate_board(test::stereo_rig(), {}, {.seed = 11}).observations;
  const auto error_output = [&](const Eigen::Matrix2d& C) {
    return test::error_message([&] {
      calibrate(observations,
                {.prior = GaussianRigPrior{
                     test::stereo_rig(), {CovarianceKind::prior, {"left.f_px", "left.ox_px"}, C}}});
    });
  };
  Eigen::Matrix2d indefinite, singular, zero;
  indefinite << 4, 7, 7, 9;
  singular << 4, 6, 6, 9;
  zero << 4, 0, 0, 0;
  EXPECT_NE(error_output(indefinite).find("not positive semi-definite: negative variance where"),
            std::string::npos);
  EXPECT_NE(error_output(indefinite).find("the left focal length against the left centre (x)"),
            std::string::npos);
  EXPECT_NE(error_output(singular).find("singular: no variance where"), std::string::npos);
  EXPECT_NE(error_output(zero).find("prior of left.ox_px: its variance is 0"), std::string::npos);
  EXPECT_NE(test::error_message([&] {
              calibrate(observations, {.known = {{"left.f_px", 525, 0}}});
            }).find("0 is not a standard deviation"),
            std::string::npos);
  EXPECT_NE(test::error_message([&] {
              calibrate(observations, {.known = {{"left.p1", 0, 1}}});
            }).find("prior of left.p1: the rig has no such parameter"),
            std::string::npos);
}

TEST(BoardWarpTest, IsFoundAndWithoutItTheRigIsWrong) {
  const Eigen::Vector2d warp_m(1.5e-3, -0.8e-3);
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 17, .frames = 30});
  const BoardObservations observations = test::bent(board, warp_m);
  const RigEstimate flat = calibrate(observations, {.pixel_sigma_px = 0.2});
  const RigEstimate free =
      calibrate(observations, {.pixel_sigma_px = 0.2, .warp = BoardWarp::free});
  EXPECT_LT((free.evidence->warp_m - warp_m).norm(), 1e-4);
  EXPECT_LT(worst_sigmas(free.rig, test::stereo_rig(), *free.covariance_mvb), 4.5);
  EXPECT_GT(worst_sigmas(flat.rig, test::stereo_rig(), *flat.covariance_mvb), 5);
  // What is not known of the board is not known of the rig.
  const RigEstimate known = calibrate(board.observations, {.pixel_sigma_px = 0.2});
  EXPECT_GT((free.covariance_mvb->diagonal().array() / known.covariance_mvb->diagonal().array())
                .minCoeff(),
            0.99);
}

TEST(MixedModels, OneACamera) {
  Rig truth = test::stereo_rig(OpenCv4{});
  truth.cameras[1] = test::stereo_rig(Pinhole{}).cameras[1];
  const auto board = simulate_board(truth, {}, {.seed = 21, .pixel_sigma_px = 0});
  const RigEstimate e =
      calibrate(board.observations, {.models = {OpenCv4{}, Pinhole{}}, .pixel_sigma_px = 1e-3});
  EXPECT_LT(worst_sigmas(e.rig, truth, *e.covariance_mvb), 1e-3);
  EXPECT_EQ(parameter_names(e.rig).size(), 8u + 4u + 6u);
  EXPECT_NE(test::error_message([&] {
              calibrate(board.observations, {.models = {Pinhole{}, Pinhole{}, Pinhole{}}});
            }).find("3 models for 2 cameras"),
            std::string::npos);
}

TEST(ModelNesting, KeepsWhatBothHaveAndLosesNothing) {
  const Rig rig = test::stereo_rig(Radial1{});
  const Rig richer = in_models(rig, {OpenCv8{}, OpenCv8{}});
  const Eigen::Vector3d x(0.3, -0.2, 1.1);
  EXPECT_EQ(project(rig.cameras[1], x), project(richer.cameras[1], x));
  EXPECT_EQ(parameters(in_models(richer, {Radial1{}, Radial1{}})), parameters(rig));
  EXPECT_NE(test::error_message([&] {
              in_models(rig, {Pinhole{}, Radial1{}});
            }).find("left.k1: the model pinhole has no such coefficient"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
