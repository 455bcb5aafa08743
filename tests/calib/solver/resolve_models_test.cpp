// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/camera.h"
#include "calib/estimate/held_parameters.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "calib/simulated_board.h"
#include "calib/solver/initial_rig.h"
#include "calib/solver/reprojection_problem.h"
#include "calib/solver/resolve.h"
#include "tests/support/resolver_oracle.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

using namespace test;

class ResolverOfEveryModel : public testing::TestWithParam<const char*> {
 protected:
  SimulatedBoard board() const { return scene(test::stereo_rig(camera_model(GetParam()))); }

  /// The denominator's coefficients nearly imitate the numerator's, which leaves a curved valley
  /// for a minimum: they are held. CovarianceIsTheBound has them free.
  ReprojectionProblem problem(const Rig& rig) const {
    if (model_name(rig.cameras[0].model) != "opencv8") return {};
    return {.held = held_mask(
                rig,
                {{"left.k4"}, {"left.k5"}, {"left.k6"}, {"right.k4"}, {"right.k5"}, {"right.k6"}})};
  }
};

TEST_P(ResolverOfEveryModel, FromTheTruth) {
  const SimulatedBoard board = this->board();
  expect_as_ceres(board.observations, board.truth, problem(board.truth.rig));
}

TEST_P(ResolverOfEveryModel, FromSomeStandardDeviationsAway) {
  const SimulatedBoard board = this->board();
  const ReprojectionProblem problem = this->problem(board.truth.rig);
  expect_as_ceres(board.observations, perturbed(board, 5, problem), problem);
}

TEST_P(ResolverOfEveryModel, WithPartialBoards) {
  SimulatedBoard board = this->board();
  make_partial(board.observations);
  expect_as_ceres(board.observations, board.truth, problem(board.truth.rig));
}

TEST_P(ResolverOfEveryModel, FromTheCornersAlone) {
  SimulatedBoard board = this->board();
  check_and_sort(board.observations);
  const CameraModel model = camera_model(GetParam());
  BoardState start = initial_state(board.observations, {model, model});
  expect_as_ceres(board.observations, start, problem(start.rig));
}

TEST_P(ResolverOfEveryModel, FreeWarpIsFound) {
  SimulatedBoard board = bent(this->board(), {2e-3, -1e-3});
  ReprojectionProblem problem = this->problem(board.truth.rig);
  problem.warp = BoardWarp::free;
  expect_as_ceres(board.observations, board.truth, problem);
  const ResolveResult result = Resolver(board.observations, board.truth, problem).resolve();
  EXPECT_LT((result.state.warp_m - Eigen::Vector2d(2e-3, -1e-3)).norm(), 1e-4);
}

TEST_P(ResolverOfEveryModel, CovarianceIsTheBound) {
  SimulatedBoard board = this->board();
  make_partial(board.observations);
  const int n = parameter_count(board.truth.rig);
  RigPrior prior{board.truth.rig, Eigen::MatrixXd::Zero(n, n)};
  const std::vector<std::string> names = parameter_names(board.truth.rig);
  for (int i = 0; i < n; ++i) {  // tells numerator and denominator of opencv8 apart
    const std::string& name = names[static_cast<std::size_t>(i)];
    if (name.ends_with("k4") || name.ends_with("k5") || name.ends_with("k6")) {
      prior.information(i, i) = 1e4;
    }
  }
  for (const BoardWarp warp : {BoardWarp::known, BoardWarp::free}) {
    ReprojectionProblem problem{.pixel_sigma_px = sigma_px, .priors = {prior}, .warp = warp};
    problem.held = held_mask(board.truth.rig, {{"right.ax"}, {"right.tz_m"}});
    const Reference plain(board.observations, board.truth, problem);
    const Eigen::MatrixXd C =
        Resolver(board.observations, board.truth, problem).covariance(board.truth);
    const Eigen::MatrixXd off =
        (C - plain.covariance).cwiseQuotient(plain.sd * plain.sd.transpose());
    EXPECT_LT(off.cwiseAbs().maxCoeff(), 1e-5);
    EXPECT_TRUE(C.col(1 + intrinsics_index(board.truth.rig, 1)).isZero(0));  // right.ax
  }
}

INSTANTIATE_TEST_SUITE_P(
    Models,
    ResolverOfEveryModel,
    testing::Values("pinhole", "radial1", "opencv4", "opencv5", "opencv8", "fisheye4"));

}  // namespace
}  // namespace vernier
