// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "datasets/shipped.h"

#include <gtest/gtest.h>

#include "calib/base/atomic_file.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "sim/world.h"
#include "sim/world_file.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::sim;

namespace {

const std::string folder = VERNIER_SOURCE_DIR "/datasets/";

TEST(Workshop, IsWhatItsRecipeMakes) {
  EXPECT_EQ(format_world(datasets::workshop()), read_whole(folder + "worlds/workshop.world.toml"));
}

TEST(Workshop, IsOfTheMemosSize) {
  const World world = build_world(read_world(folder + "worlds/workshop.world.toml"));
  EXPECT_GE(world.segments.size(), 7000u);
  EXPECT_GE(world.corners.size(), 1000u);
  EXPECT_GE(repeated_share(world), 0.4);
  const WorldExtent box = extent(world);
  EXPECT_LT((box.high_m - box.low_m - Eigen::Vector3d(20, 15, 2.5)).norm(), 1e-6);
  EXPECT_GT(map_poses(world.route, 0.5).size(), 150u);
}

/// Largest difference of two covariances' entries over the deviations that the second one states.
double relative_difference(const Eigen::MatrixXd& made, const Eigen::MatrixXd& shipped) {
  const Eigen::VectorXd sd = shipped.diagonal().cwiseSqrt();
  return (made - shipped).cwiseQuotient(sd * sd.transpose()).cwiseAbs().maxCoeff();
}

// Its covariance comes from our own calibration, so a better solver may move it in the last digits:
// the file is what studies read, the recipe must agree with it far within the errors it states.
TEST(Nominal, IsWhatItsRecipeMakes) {
  const RigEstimate shipped = read_rig(folder + "rigs/nominal.rig.json").estimate;
  const RigEstimate made = datasets::nominal();
  ASSERT_TRUE(shipped.covariance);
  const Eigen::VectorXd sd = shipped.covariance->matrix.diagonal().cwiseSqrt();
  EXPECT_LT(difference(made.rig, shipped.rig).cwiseQuotient(sd).cwiseAbs().maxCoeff(), 1e-6);
  ASSERT_TRUE(made.covariance);
  EXPECT_EQ(made.covariance->kind, shipped.covariance->kind);
  EXPECT_LT(relative_difference(made.covariance->matrix, shipped.covariance->matrix), 1e-6);
  ASSERT_TRUE(made.covariance_mvb && shipped.covariance_mvb);
  EXPECT_LT(relative_difference(*made.covariance_mvb, *shipped.covariance_mvb), 1e-6);
  EXPECT_NEAR(shipped.rig.cameras[0].f_px(), 525, 5);
  EXPECT_NEAR(shipped.rig.T_camera_first[1].t.norm(), 0.2, 0.002);
}

}  // namespace
}  // namespace vernier
