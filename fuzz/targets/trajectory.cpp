// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/trajectory.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calib/pose.h"
#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {
namespace {

using localise::read_trajectory;
using localise::TimedPose;

void run_trajectory(std::string_view bytes) {
  const std::filesystem::path file = input_file(bytes, "trajectory.txt");
  const auto poses = accepted([&] { return read_trajectory(file); });
  if (!poses) return;
  const auto again = read_trajectory(input_file(localise::tum_text(*poses), "written.txt"));
  require(again.size() == poses->size(), "all poses are written");
  constexpr double rounding = 1e-12;
  for (std::size_t i = 0; i < again.size(); ++i) {
    const TimedPose &a = (*poses)[i], &b = again[i];
    require(a.time_s == b.time_s && a.T_world_camera.t == b.T_world_camera.t,
            "times and positions are kept");
    require((a.T_world_camera.R - b.T_world_camera.R).norm() < rounding, "rotations are kept");
  }
}

std::vector<std::string> trajectory_seeds() {
  std::vector<TimedPose> poses;
  for (int i = 0; i < 4; ++i) {
    poses.push_back({i / 10.0, {rotation_from_vector({0.1 * i, 1.0 * i, 0}), {i / 3.0, 2, -7}}});
  }
  return {localise::tum_text(poses), "1 0 0 0 0 1 0 0 0 0 1 0\n0 0 1 0.5 0 1 0 -2 -1 0 0 1e3\n"};
}

const Registered registered_trajectory{
    {"trajectory", 2000, "columns", run_trajectory, trajectory_seeds}};

}  // namespace
}  // namespace vernier::fuzz
