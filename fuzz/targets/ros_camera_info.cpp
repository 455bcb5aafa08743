// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calib/formats/imported_rig.h"
#include "calib/formats/ros_camera_info.h"
#include "calib/rig.h"
#include "fuzz/example_rigs.h"
#include "fuzz/fuzz_target.h"
#include "fuzz/same_values.h"
#include "stereo/rectification/rectified_camera_info.h"

namespace vernier::fuzz {
namespace {

using namespace vernier::internal;

void run_ros_camera_info(std::string_view bytes) {
  const auto both = split_at_line(bytes, right_file);
  const std::string_view left = both.first, right = both.second;
  std::vector<std::filesystem::path> files{input_file(left, "left.yaml")};
  if (!right.empty()) files.push_back(input_file(right, "right.yaml"));
  accepted([&] { return read_ros_camera_info(files); });
  const auto info = accepted([&] { return parse_ros_camera_info(std::string(left), "left.yaml"); });
  if (!info) return;
  const auto file = accepted([&] { return format_ros_camera_info(*info); });
  if (!file) return;
  const RosCameraInfo again = parse_ros_camera_info(file->text, "written");
  const auto rig = accepted([&] { return rig_of({{info->camera, {}}}); });
  if (!rig) return;  // its name is too long for a rig
  require_close(*rig, rig_of({{again.camera, {}}}));
  require(info->P == again.P, "the projection is kept");
  require((info->R_rectified_camera - again.R_rectified_camera).cwiseAbs().maxCoeff() <= 1e-12,
          "the rectification is kept");
}

std::vector<std::string> ros_camera_info_seeds() {
  std::vector<std::string> seeds;
  for (const char* model : {"pinhole", "opencv5", "opencv8", "fisheye4"}) {
    std::string both;
    for (const RosCameraInfo& info :
         stereo::internal::rectified_camera_info(example_rig(model, 2))) {
      const std::string text = format_ros_camera_info(info).text;
      seeds.push_back(text);
      both += (both.empty() ? "" : std::string(right_file) + "\n") + text;
    }
    seeds.push_back(both);
  }
  return seeds;
}

const Registered registered_ros_camera_info{
    {"ros_camera_info", 4000, "ros", run_ros_camera_info, ros_camera_info_seeds}};

}  // namespace
}  // namespace vernier::fuzz
