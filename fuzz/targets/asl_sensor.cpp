// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/formats/asl_sensor.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calib/formats/imported_rig.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "fuzz/fuzz_target.h"

namespace vernier::fuzz {
namespace {

using namespace vernier::internal;

void run_asl_sensor(std::string_view bytes) {
  const auto [left, right] = split_at_line(bytes, right_file);
  std::vector<std::filesystem::path> files{input_file(left, "left.yaml")};
  if (!right.empty()) files.push_back(input_file(right, "right.yaml"));
  const auto read = accepted([&] { return read_asl_sensors(files); });
  if (!read) return;
  require(read->rig.cameras.size() == files.size(), "each file is a camera");
  require(read->T_body_first.has_value(), "the body is known");
  for (const Pose& T : read->rig.T_camera_first) {
    require((T.R * T.R.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-9,
            "poses are rotations");
  }
}

std::vector<std::string> asl_sensor_seeds() {
  const auto sensor = [](const std::string& distortion, double x) {
    return "%YAML:1.0\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1.0, 0.0, 0.0, " +
           std::to_string(x) +
           ",\n    0.0, 1.0, 0.0, 0.0,\n    0.0, 0.0, 1.0, 0.0,\n    0.0, 0.0, 0.0, 1.0]\n"
           "rate_hz: 20\nresolution: [752, 480]\ncamera_model: pinhole\n"
           "intrinsics: [458.654, 457.296, 367.215, 248.375] #fu\ndistortion_model: " +
           distortion + "\ndistortion_coefficients: [-0.28, 0.07, 0.0002, 1.8e-05]\n";
  };
  return {sensor("radial-tangential", 0), sensor("equidistant", 0), sensor("none", 0),
          sensor("radtan", 0) + std::string(right_file) + "\n" + sensor("radtan", 0.1)};
}

const Registered registered_asl_sensor{
    {"asl_sensor", 3000, "kalibr", run_asl_sensor, asl_sensor_seeds}};

}  // namespace
}  // namespace vernier::fuzz
