// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/import/camera_path.h"

#include <Eigen/Core>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "calib/pose.h"
#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {
namespace {

using namespace sim::internal;

/// The cameras of a COLMAP model whose way becomes a world's route.
void run_camera_path(std::string_view bytes) {
  input_file(bytes, "images.txt");
  auto cameras = accepted([&] { return read_camera_path(input_folder()); });
  if (!cameras) return;
  require(!cameras->empty(), "what is accepted holds a camera");
  for (const PathCamera& camera : *cameras) {
    const Pose& T = camera.T_camera_world;
    require((T.R * T.R.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-9 && T.t.allFinite(),
            "poses are poses");
  }
  Mesh none;
  const auto up = accepted([&] { return up_of(*cameras, none, "model"); });
  if (!up) return;
  require(std::abs(up->norm() - 1) < 1e-9, "up is a direction");
  level(*up, none, *cameras);
  route_of(*cameras, 1, Eigen::Vector2d::Zero());
}

std::vector<std::string> camera_path_seeds() {
  return {"1 1 0 0 0 0.5 0 0 1 walk/a.png\n\n2 1 0 0 0 0 1 1 1 b10.png\n1 2 3\n",
          "# a comment\n1 0.7 0 0.7 0 0 0 0 1 a2.png\n\n3 0.7 0 0.7 0 4 0 0 1 a10.png\n\n"};
}

const Registered registered_camera_path{
    {"camera_path", 2000, "columns", run_camera_path, camera_path_seeds}};

}  // namespace
}  // namespace vernier::fuzz
