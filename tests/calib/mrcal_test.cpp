// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "calib/calibrate.h"
#include "calib/mrcal/mrcal_comparison.h"
#include "calib/mrcal/mrcal_parameters.h"
#include "calib/mrcal/mrcal_problem.h"
#include "calib/simulated_board.h"
#include "tests/support/numeric_jacobian.h"
#include "tests/support/scenes.h"

namespace vernier {
namespace {

/// A rig of one to three cameras with this model; the pictures of "hd" are twice as wide and high.
Rig rig_of(const CameraModel& model, int cameras, int scale) {
  Rig rig = test::stereo_rig(model);
  rig.cameras.push_back(rig.cameras[0]);
  rig.cameras[2].name = "third";
  rig.T_camera_first.push_back(
      {rotation_from_vector({-0.02, 0.03, 0.4}), Eigen::Vector3d(0.15, -0.03, 0.01)});
  rig.cameras.resize(cameras);
  rig.T_camera_first.resize(cameras);
  for (Camera& camera : rig.cameras) {
    if (std::holds_alternative<OpenCv8>(model)) {  // a wide angle, or it is not determined
      camera.parameters[0] = 250;
      camera.parameters.tail<8>() << 0.3, 0.05, 4e-4, -3e-4, 0.01, 0.6, 0.2, 0.05;
    }
    camera.size_px *= scale;
    camera.parameters[0] *= scale;
    camera.parameters.segment<2>(2) *= scale;
  }
  return rig;
}

struct Scene {
  const char* model;
  int cameras, scale;
};

class AgainstMrcal : public testing::TestWithParam<Scene> {};

TEST_P(AgainstMrcal, ParametersAndCovarianceAgree) {
  if (!mrcal_available()) GTEST_SKIP() << "this build has no libmrcal";
  const auto [name, cameras, scale] = GetParam();
  const CameraModel model = camera_model(name);
  const bool wide = std::holds_alternative<OpenCv8>(model);
  const SimulatedBoard board =
      simulate_board(rig_of(model, cameras, scale), {10, 8, 0.06}, 3, 0,
                     {.frames = 24, .pixel_sigma_px = 0.1, .distance_m = wide ? 0.6 : 0.9});
  const std::vector<CameraModel> models(cameras, model);
  const BoardState start = initial_state(board.observations, models);
  const BoardState ours = minimise_reprojection(board.observations, start);
  const MrcalCheck check = check_against_mrcal(
      board.observations, start, refine_minimum(board.observations, ours), 0.1);
  const MrcalComparison& difference = check.comparison;
  std::printf("%s %d %d: %g %s  %g %s cost %g short %g cpu %g %s\n", name, cameras, scale,
              difference.max_parameter_diff_sigma, difference.worst_parameter.c_str(),
              difference.max_covariance_diff, difference.worst_covariance.c_str(),
              difference.cost_relative_diff, check.solution.stopped_short_sigma,
              check.solution.solve_cpu_ms, check.restarted.c_str());
  EXPECT_LE(difference.max_parameter_diff_sigma, parameter_gate_sigma)
      << difference.worst_parameter;
  EXPECT_LE(difference.max_covariance_diff, covariance_gate) << difference.worst_covariance;
  EXPECT_LE(std::abs(difference.cost_relative_diff), 1e-11);
}

std::vector<Scene> scenes() {
  std::vector<Scene> all;
  for (const char* model : {"pinhole", "radial1", "opencv4", "opencv5", "opencv8"}) {
    all.insert(all.end(), {{model, 1, 1}, {model, 2, 1}, {model, 2, 2}, {model, 3, 1}});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Models, AgainstMrcal, testing::ValuesIn(scenes()), [](const auto& info) {
  return std::string(info.param.model) + "_" + std::to_string(info.param.cameras) +
         (info.param.scale == 1 ? "_vga" : "_hd");
});

}  // namespace
}  // namespace vernier
