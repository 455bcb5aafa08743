// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/views/camera_poses.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calib/pose.h"
#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {
namespace {

using namespace localise::internal;

/// The first byte says what the file is called: COLMAP's are known by their name.
void run_camera_poses(std::string_view bytes) {
  const bool colmap = bytes.starts_with('c');
  const std::filesystem::path file =
      input_file(bytes.substr(bytes.empty() ? 0 : 1), colmap ? "images.txt" : "poses.csv");
  const auto read = accepted([&] { return read_camera_poses(file); });
  if (!read) return;
  require(!read->poses.empty(), "what is accepted holds a pose");
  std::vector<std::filesystem::path> images;
  for (const CameraPose& pose : read->poses) {
    const Pose& T = pose.T_world_camera;
    require((T.R * T.R.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-9 && T.t.allFinite(),
            "poses are poses");
    images.emplace_back(pose.image.empty() ? "left.png" : pose.image);
  }
  const auto found = accepted([&] { return poses_of_images(*read, images, "poses.csv"); });
  require(!found || found->size() == images.size(), "each image has a pose");
}

std::vector<std::string> camera_poses_seeds() {
  return {
      "tframe,t00,t01,t02,t03,t10,t11,t12,t13,t20,t21,t22,t23,t30,t31,t32,t33\n"
      "00003,1,0,0,0.5,0,1,0,2,0,0,1,-3,0,0,0,1\n00006,0,0,1,0.5,0,1,0,2,-1,0,0,-3,0,0,0,1\n",
      "t#timestamp, p_RS_R_x [m], p_RS_R_y [m]\n1403715273262142976,4.6,-1.7,0.8,1,0,0,0,0,0\n"
      "1403715273312143104,4.6,-1.7,0.8,0.6,0.8,0,0\n",
      "t1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0.6 0.8\n",
      "c1 1 0 0 0 0.5 0 0 1 walk/a.png\n\n2 0.6 0.8 0 0 0 0 1 1 b.png\n1 2 3\n"};
}

const Registered registered_camera_poses{
    {"camera_poses", 2000, "columns", run_camera_poses, camera_poses_seeds}};

}  // namespace
}  // namespace vernier::fuzz
