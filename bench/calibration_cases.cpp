// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "bench/calibration_faults.h"
#include "calib/board_target.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/simulated_board.h"

namespace vernier::bench {
namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

double normal(Random& random) { return std::normal_distribution<double>()(random); }

Eigen::Vector3d random_vector(Random& random) {
  return {normal(random), normal(random), normal(random)};
}

CameraModel drawn_model(Random& random) {
  switch (std::uniform_int_distribution<int>(0, 3)(random)) {
    case 0:
      return Pinhole{};
    case 1:
      return Radial1{};
    case 2:
      return OpenCv4{};
    default:
      return OpenCv5{};
  }
}

Rig drawn_rig(Random& random, const CameraModel& model) {
  constexpr int sizes[][2] = {{640, 480}, {752, 480}, {1280, 720}, {1280, 960}, {1920, 1200}};
  const auto& size = sizes[std::uniform_int_distribution<int>(0, 4)(random)];
  const double f = size[0] * uniform(random, 0.6, 1.4), wide = size[0] / f;
  Rig rig;
  for (int i = 0; i < 2; ++i) {
    Camera camera;
    camera.name = i == 0 ? "left" : "right";
    camera.model = model;
    camera.size_px = {size[0], size[1]};
    camera.parameters = Eigen::VectorXd::Zero(parameter_count(model));
    camera.parameters.head<4>() << f * (1 + 0.01 * normal(random)), 1 + 0.002 * normal(random),
        0.5 * size[0] + 0.01 * size[0] * normal(random),
        0.5 * size[1] + 0.01 * size[0] * normal(random);
    constexpr double sd[] = {0.15, 0.05, 5e-4, 5e-4, 0.02};
    for (Eigen::Index k = 4; k < camera.parameters.size(); ++k) {
      const double drawn = k == 4 ? -std::abs(normal(random)) : normal(random);
      camera.parameters[k] = sd[k - 4] * drawn / std::max(1.0, wide * wide);
    }
    rig.cameras.push_back(camera);
  }
  const Eigen::Vector3d turn = 0.015 * random_vector(random);
  const double baseline = uniform(random, 0.05, 0.25);
  const double z = 0.01 * normal(random), y = 0.01 * normal(random);
  rig.T_camera_first = {Pose{},
                        Pose{rotation_from_vector(turn), baseline * Eigen::Vector3d(-1, y, z)}};
  return rig;
}

}  // namespace

CalibrationCase simulated_case(std::uint64_t seed) {
  Random random(seed);
  for (std::uint64_t attempt = 0;; ++attempt) {
    const CameraModel model = drawn_model(random);
    const Rig rig = drawn_rig(random, model);
    const int rows = std::uniform_int_distribution<int>(5, 8)(random);
    const int columns = rows + std::uniform_int_distribution<int>(1, 4)(random);
    const Chessboard board{columns, rows, uniform(random, 0.015, 0.05)};
    SimulatedBoardOptions how;
    how.seed = 1000 * seed + attempt;
    how.frames = std::uniform_int_distribution<int>(8, 60)(random);
    how.pixel_sigma_px = uniform(random, 0.05, 0.4);
    const double width = board.square_m * columns;
    how.distance_m =
        width * rig.cameras[0].f_px() / rig.cameras[0].size_px.x() * uniform(random, 2, 4);
    how.tilt_rad = uniform(random, 0.4, 0.8);
    try {
      SimulatedBoard drawn = simulate_board(rig, board, how);
      CalibrationCase c{std::move(drawn.observations), std::move(drawn.truth), {}};
      c.options.model = model;
      return c;
    } catch (const Error&) {  // the board fits no view of both cameras
      if (attempt > 50) throw;
    }
  }
}

CalibrationCase subset_of(const CalibrationCase& whole,
                          const std::function<bool(std::size_t place, std::size_t n)>& kept) {
  const std::vector<int> frames = frames_of(whole.observations);
  std::vector<int> chosen;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (kept(i, frames.size())) chosen.push_back(frames[i]);
  }
  CalibrationCase part = whole;
  part.observations = at_frames(whole.observations, chosen);
  return part;
}

}  // namespace vernier::bench
