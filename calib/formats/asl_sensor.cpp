// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/formats/asl_sensor.h"

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <system_error>
#include <utility>

#include "calib/base/atomic_file.h"
#include "calib/base/shown_text.h"
#include "calib/camera.h"
#include "calib/camera/opencv_intrinsics.h"
#include "calib/error.h"
#include "calib/formats/imported_rig.h"
#include "calib/formats/yaml_node.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal {
namespace {

OpenCvIntrinsics asl_intrinsics(const YamlNode& root) {
  const YamlNode model = root.at("camera_model");
  if (model.text() != "pinhole") {
    throw Error(model.place(), "unsupported camera model " + in_quotes(model.text()),
                "only pinhole is supported");
  }
  const std::vector<double> core = root.at("intrinsics").numbers(4);
  const YamlNode distortion = root.at("distortion_model");
  const std::string name = distortion.text();
  const bool radial = name == "radial-tangential" || name == "radtan";
  if (!radial && name != "equidistant" && name != "none") {
    throw Error(distortion.place(), "unsupported distortion model " + in_quotes(name),
                "supported: radial-tangential, equidistant, none");
  }
  OpenCvIntrinsics in{core[0], core[1], core[2], core[3], name == "equidistant", {}};
  if (name == "none") return in;
  in.coefficients = root.at("distortion_coefficients").numbers();
  const std::size_t n = in.coefficients.size();
  if (n != 4 && !(radial && n == 5)) {
    throw Error(root.at("distortion_coefficients").place(), fmt::format("holds {} coefficients", n),
                "give four");
  }
  return in;
}

PlacedCamera read_camera(const std::filesystem::path& file, const ImportOptions& options) {
  const YamlNode root = YamlNode::parse(read_whole(file), file.string());
  if (root.has("sensor_type") && root.at("sensor_type").text() != "camera") {
    throw Error(root.at("sensor_type").place(),
                "is of the sensor " + in_quotes(root.at("sensor_type").text()),
                "give the sensor.yaml of a camera");
  }
  PlacedCamera placed;
  placed.camera = camera_from_opencv(asl_intrinsics(root), root.at("resolution").size_px(),
                                     file.string(), options.model);
  const bool by_folder = file.filename() == "sensor.yaml" && file.has_parent_path();
  placed.camera.name = (by_folder ? file.parent_path().filename() : file.stem()).string();
  placed.T_camera_reference = imported_pose(root.at("T_BS"), options.unit_m).inverse();
  return placed;
}

}  // namespace

ImportedRig read_asl_sensors(const std::vector<std::filesystem::path>& files_or_folder,
                             const ImportOptions& options) {
  std::vector<std::filesystem::path> files = files_or_folder;
  if (files.size() == 1 && std::filesystem::is_directory(files[0])) {
    files = asl_sensor_files(files[0]);
    if (files.empty()) {
      throw Error(files_or_folder[0].string(), "is a folder without a cam0/sensor.yaml",
                  "give an ASL folder, such as mav0, or its sensor.yaml files");
    }
  }
  std::vector<PlacedCamera> cameras;
  for (const std::filesystem::path& file : files) cameras.push_back(read_camera(file, options));
  ImportedRig imported;
  imported.T_body_first = cameras.at(0).T_camera_reference.inverse();
  imported.rig = rig_of(std::move(cameras));
  return imported;
}

std::vector<std::filesystem::path> asl_sensor_files(const std::filesystem::path& folder) {
  std::error_code fault;
  for (const std::filesystem::path& root : {folder, folder / "mav0"}) {
    std::vector<std::filesystem::path> files;
    for (int i = 0;; ++i) {
      const std::filesystem::path file = root / fmt::format("cam{}", i) / "sensor.yaml";
      if (!std::filesystem::is_regular_file(file, fault)) break;
      files.push_back(file);
    }
    if (!files.empty()) return files;
  }
  return {};
}

}  // namespace vernier::internal
