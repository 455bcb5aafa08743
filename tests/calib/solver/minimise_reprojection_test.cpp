// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/minimise_reprojection.h"

#include <gtest/gtest.h>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/estimate/held_parameters.h"
#include "calib/lens_models.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "calib/simulated_board.h"
#include "calib/solver/reprojection_problem.h"
#include "tests/support/error_message.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

using test::error_message;

// A pair whose right camera saw nothing.
class CameraWithoutViews : public testing::Test {
 protected:
  CameraWithoutViews() {
    std::erase_if(board_.observations.views, [](const BoardView& v) { return v.camera == 1; });
    all_ = {{"right.f_px", {}}, {"right.ax", {}},     {"right.ox_px", {}},  {"right.oy_px", {}},
            {"right.k1", {}},   {"right.wx_rad", {}}, {"right.wy_rad", {}}, {"right.wz_rad", {}},
            {"right.tx_m", {}}, {"right.ty_m", {}},   {"right.tz_m", {}}};
  }

  std::string error_output(const ReprojectionProblem& problem) const {
    return error_message(
        [&] { minimise_reprojection(board_.observations, board_.truth, problem); });
  }

  SimulatedBoard board_ = simulate_board(test::stereo_rig(), {}, {.seed = 5});
  Rig rig_ = board_.truth.rig;
  std::vector<HeldParameter> all_;  // of the right camera
};

TEST_F(CameraWithoutViews, IsNamed) {
  const std::string expected =
      "camera 1 (\"right\"): it has no view of the board, and no prior gives its f_px; add views "
      "of it, or give fixed values or priors for all of its parameters";
  EXPECT_EQ(error_output({}), expected);
  EXPECT_EQ(error_output({.held = held_mask(rig_, {{"right.k1", {}}})}), expected);
}

TEST_F(CameraWithoutViews, MayBeHeld) {
  const BoardState solved =
      minimise_reprojection(board_.observations, board_.truth, {.held = held_mask(rig_, all_)});
  EXPECT_EQ(solved.rig.cameras[1].parameters, rig_.cameras[1].parameters);
  EXPECT_NE(solved.rig.cameras[0].parameters, rig_.cameras[0].parameters);
  all_.erase(all_.begin() + 6);
  EXPECT_NE(error_output({.held = held_mask(rig_, all_)}).find("no prior gives its wy_rad"),
            std::string::npos);
}

TEST_F(CameraWithoutViews, MayBeKnownFromElsewhere) {
  std::vector<ParameterPrior> known;
  const Eigen::VectorXd values = parameters(rig_);
  for (std::size_t i = 0; i < all_.size(); ++i) {
    known.push_back({all_[i].name, values[5 + static_cast<Eigen::Index>(i)] + 1e-3, 1e-3});
  }
  const ReprojectionProblem problem{.priors = {rig_prior(rig_, known)}};
  const BoardState solved = minimise_reprojection(board_.observations, board_.truth, problem);
  for (std::size_t i = 0; i < known.size(); ++i) {
    EXPECT_NEAR(parameters(solved.rig)[5 + static_cast<Eigen::Index>(i)], known[i].value, 1e-9)
        << known[i].name;
  }
}

TEST(MinimiseReprojection, RefusesAProblemOfAnotherRig) {
  const SimulatedBoard board = simulate_board(test::stereo_rig(), {}, {.seed = 5});
  const auto error_output = [&](const ReprojectionProblem& problem) {
    return error_message([&] { minimise_reprojection(board.observations, board.truth, problem); });
  };
  EXPECT_EQ(error_output({.held = held_mask(test::stereo_rig(Pinhole{}), {})}),
            "held parameters: there is not one flag per rig parameter; make them with "
            "held_mask");
  EXPECT_EQ(error_output({.priors = {{board.truth.rig, Eigen::MatrixXd::Identity(3, 3)}}}),
            "prior: it does not match the rig's parameters; make it with rig_prior");
  EXPECT_EQ(error_output({.corner_weights = {{1.0}}}),
            "corner weights: there is not one per corner; give one per corner");
}

}  // namespace
}  // namespace vernier
