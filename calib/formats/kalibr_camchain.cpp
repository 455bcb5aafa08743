// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/formats/kalibr_camchain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>
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

/// The second last component of a topic: left of /stereo/left/image_raw.
std::string camera_of_topic(const std::string& topic) {
  const std::size_t last = topic.rfind('/');
  if (last == std::string::npos || last == 0) return "";
  const std::size_t before = topic.rfind('/', last - 1);
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  return topic.substr(begin, last - begin);
}

OpenCvIntrinsics read_intrinsics(const YamlNode& node) {
  const YamlNode model = node.at("camera_model");
  if (model.text() != "pinhole") {
    throw Error(model.place(), "unsupported camera model " + in_quotes(model.text()),
                "calibrate with pinhole-radtan or pinhole-equi");
  }
  const std::vector<double> core = node.at("intrinsics").numbers(4);
  const YamlNode distortion = node.at("distortion_model");
  const std::string name = distortion.text();
  if (name != "radtan" && name != "equidistant" && name != "none") {
    throw Error(distortion.place(), "unsupported distortion model " + in_quotes(name),
                "supported: radtan, equidistant, none");
  }
  OpenCvIntrinsics in{core[0], core[1], core[2], core[3], name == "equidistant", {}};
  if (name != "none") in.coefficients = node.at("distortion_coeffs").numbers(4);
  return in;
}

std::string camera_text(const Camera& camera, const std::string& others) {
  const OpenCvIntrinsics in = opencv_intrinsics(camera);
  const bool none = in.coefficients.empty();
  const std::vector<double> k = held_coefficients(camera, none ? 0 : 4, "Kalibr's radtan");
  return fmt::format(
      "  cam_overlaps: [{}]\n  camera_model: pinhole\n  intrinsics: [{}]\n"
      "  distortion_model: {}\n  distortion_coeffs: [{}]\n  resolution: [{}, {}]\n"
      "  rostopic: {}\n",
      others, yaml_list(std::vector<double>{in.fx_px, in.fy_px, in.cx_px, in.cy_px}),
      none         ? "none"
      : in.fisheye ? "equidistant"
                   : "radtan",
      yaml_list(k), camera.size_px[0], camera.size_px[1],
      yaml_text("/" + file_stem(camera) + "/image_raw"));
}

std::string step_text(const Pose& T) {
  std::string text = "  T_cn_cnm1:\n";
  for (int r = 0; r < 3; ++r) {
    text += fmt::format("  - [{}, {}, {}, {}]\n", T.R(r, 0), T.R(r, 1), T.R(r, 2), T.t[r]);
  }
  return text + "  - [0.0, 0.0, 0.0, 1.0]\n";
}

}  // namespace

ImportedRig read_kalibr_camchain(const std::filesystem::path& file, const ImportOptions& options) {
  const YamlNode root = YamlNode::parse(read_whole(file), file.string());
  if (!root.has("cam0")) {
    throw Error(file.string(), "is not a camchain: it has no \"cam0\"", "name another file");
  }
  ImportedRig imported;
  std::vector<PlacedCamera> cameras;
  std::set<std::string> names;
  for (std::size_t i = 0; root.has(fmt::format("cam{}", i)); ++i) {
    const YamlNode node = root.at(fmt::format("cam{}", i));
    Camera camera = camera_from_opencv(read_intrinsics(node), node.at("resolution").size_px(),
                                       node.place(), options.model);
    if (node.has("rostopic")) camera.name = camera_of_topic(node.at("rostopic").text());
    if (!camera.name.empty()) names.insert(camera.name);
    for (const char* key : {"T_cam_imu", "timeshift_cam_imu"}) {
      if (node.has(key)) imported.notes.push_back(node.at(key).place() + " is ignored");
    }
    const Pose T = i == 0 ? Pose{}
                          : imported_pose(node.at("T_cn_cnm1"), options.unit_m) *
                                cameras.back().T_camera_reference;
    cameras.push_back({camera, T});
  }
  if (names.size() != cameras.size()) {
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      cameras[i].camera.name = fmt::format("cam{}", i);
    }
  }
  imported.rig = rig_of(std::move(cameras));
  return imported;
}

std::vector<ExportedFile> kalibr_camchain(const Rig& rig) {
  std::string text;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    std::string others;
    for (std::size_t other = 0; other < rig.cameras.size(); ++other) {
      if (other != i) others += (others.empty() ? "" : ", ") + std::to_string(other);
    }
    text += fmt::format("cam{}:\n", i) + camera_text(rig.cameras[i], others);
    if (i > 0) text += step_text(rig.T_camera_first[i] * rig.T_camera_first[i - 1].inverse());
  }
  return {{"camchain.yaml", text}};
}

}  // namespace vernier::internal
