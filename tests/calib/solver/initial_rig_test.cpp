// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/initial_rig.h"

#include <gtest/gtest.h>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/observation_checks.h"
#include "calib/calibration/outliers.h"
#include "calib/calibration/view_checks.h"
#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/simulated_board.h"
#include "calib/solver/minimise_reprojection.h"
#include "tests/support/board_defects.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

/// A rig and how its board is shown.
struct Lens {
  const char* name;
  CameraModel model;
  double f_px;
  Eigen::Vector2i size_px;
  double baseline_m;
  std::vector<double> distortion;
  SimulatedBoardOptions board;
};

Rig rig_of(const Lens& lens) {
  Rig rig = test::stereo_rig(lens.model);
  for (int i = 0; i < 2; ++i) {
    Camera& camera = rig.cameras[i];
    camera.size_px = lens.size_px;
    camera.parameters.head<4>() << lens.f_px * (1 + 0.004 * i), 1.001,
        0.5 * lens.size_px[0] + 3 - 4 * i, 0.5 * lens.size_px[1] - 5 + 3 * i;
    for (std::size_t k = 0; k < lens.distortion.size(); ++k) {
      camera.parameters[core_parameter_count + static_cast<Eigen::Index>(k)] = lens.distortion[k];
    }
  }
  rig.T_camera_first[1].t.x() = -lens.baseline_m;
  return rig;
}

BoardObservations views_of(const Lens& lens, std::uint64_t seed) {
  SimulatedBoardOptions options = lens.board;
  options.seed = seed;
  return simulate_board(rig_of(lens), {}, options).observations;
}

class Starts : public testing::TestWithParam<Lens> {};

TEST_P(Starts, ByThemselvesAndWithoutAComplaint) {
  const Lens& lens = GetParam();
  for (std::uint64_t seed = 600; seed < 606; ++seed) {
    BoardObservations seen = views_of(lens, seed);
    check_and_sort(seen);
    EXPECT_TRUE(check_observations(seen).trust_warnings.empty());
    const BoardState start = initial_state(seen, {lens.model, lens.model});
    EXPECT_NEAR(start.rig.cameras[0].f_px() / lens.f_px, 1, 0.1) << "seed " << seed;
    EXPECT_TRUE(check_views(seen, start).trust_warnings.empty());
    const BoardState end = minimise_reprojection(seen, start);
    EXPECT_NEAR(robust_pixel_sigma(corner_residuals(seen, end)), 0.2, 0.02) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Lenses,
    Starts,
    testing::Values(Lens{"pinhole", Pinhole{}, 525, {640, 480}, 0.2, {}, {.frames = 15}},
                    Lens{"radial1", Radial1{}, 525, {640, 480}, 0.2, {-0.12}, {.frames = 15}},
                    Lens{"long_opencv4",
                         OpenCv4{},
                         4000,
                         {1280, 960},
                         0.3,
                         {-0.05, 0.1, 1e-4, -1e-4},
                         {.frames = 15, .distance_m = 2.5}},
                    Lens{"wide_opencv5",
                         OpenCv5{},
                         350,
                         {640, 480},
                         0.06,
                         {-0.25, 0.06, 1e-4, -2e-4, -0.006},
                         {.frames = 15, .distance_m = 0.35}},
                    Lens{"fisheye_of_120_degrees",
                         Fisheye4{},
                         305,
                         {640, 480},
                         0.06,
                         {-0.02, 0.005, -0.002, 0.0003},
                         {.frames = 15, .distance_m = 0.25, .tilt_rad = 0.35}},
                    Lens{"fisheye_of_150_degrees",
                         Fisheye4{},
                         490,
                         {1280, 960},
                         0.06,
                         {0.05, -0.01, 0.002, 0},
                         {.frames = 15, .distance_m = 0.2, .tilt_rad = 0.35}}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(InitialRig, StartsARationalLens) {
  const Lens lens{"rational",
                  OpenCv8{},
                  300,
                  {640, 480},
                  0.06,
                  {0.6, 0.1, 1e-4, -2e-4, 0.01, 0.95, 0.3, 0.03},
                  {.frames = 15, .distance_m = 0.3, .tilt_rad = 0.35}};
  for (std::uint64_t seed = 600; seed < 606; ++seed) {
    const BoardObservations seen = views_of(lens, seed);
    const BoardState start = initial_state(seen, {lens.model, lens.model});
    for (const Camera& camera : start.rig.cameras) {
      EXPECT_NEAR(camera.f_px() / lens.f_px, 1, 0.1) << "seed " << seed;
    }
  }
}

class BadViews : public testing::TestWithParam<std::uint64_t> {};

TEST_P(BadViews, DoNotRuinTheStart) {
  BoardObservations seen =
      simulate_board(test::stereo_rig(), {}, {.seed = GetParam(), .frames = 13}).observations;
  test::half_turn(test::view_of(seen, 2, 1));
  test::mirror(test::view_of(seen, 5, 0), 9);
  test::exchange(seen, 8);
  test::view_of(seen, 10, 1).pixels_px[13].x() += 40;
  const BoardState start = initial_state(seen, {Radial1{}, Radial1{}});
  EXPECT_NEAR(start.rig.cameras[0].f_px() / 525, 1, 0.1);
  EXPECT_NEAR(start.rig.cameras[1].f_px() / 528, 1, 0.1);
  const Pose error = start.rig.T_camera_first[1] * test::stereo_rig().T_camera_first[1].inverse();
  EXPECT_LT(vector_from_rotation(error.R).norm(), 0.05);
  EXPECT_LT(error.t.norm(), 0.08);
}

INSTANTIATE_TEST_SUITE_P(Seeds, BadViews, testing::Range<std::uint64_t>(620, 630));

TEST(ConsensusPose, IsWhatMostAgreeOn) {
  const Pose agreed{rotation_from_vector({0.1, 0.2, 0}), {-0.2, 0, 0}};
  std::vector<Pose> candidates;
  for (int i = -3; i <= 3; ++i) {
    candidates.push_back({rotation_from_vector({0.001 * i, 0, 0}) * agreed.R,
                          agreed.t + Eigen::Vector3d(0, 0.001 * i, 0)});
  }
  candidates.push_back({rotation_from_vector({0, 0, 3}), {1, 1, 1}});
  candidates.push_back(agreed.inverse());
  const Pose found = consensus_pose(candidates);
  EXPECT_LT(vector_from_rotation(found.R * agreed.R.transpose()).norm(), 1e-9);
  EXPECT_LT((found.t - agreed.t).norm(), 1e-9);
}

}  // namespace
}  // namespace vernier
