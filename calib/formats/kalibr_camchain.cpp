// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/formats/kalibr_camchain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <numbers>
#include <optional>
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

/// Names of topics have no blanks, and may have parts.
std::string topic_of(const Camera& camera) {
  const std::size_t begin = camera.name.find_first_not_of('/');
  const bool plain = begin != std::string::npos &&
                     std::all_of(camera.name.begin(), camera.name.end(),
                                 [](unsigned char c) { return c > 0x20 && c != 0x7f; });
  if (!plain) {
    throw Error(fmt::format("camera \"{}\"", camera.name), "its name is none of a ROS topic",
                "rename the cameras, as convert --names left,right does");
  }
  return "/" + camera.name.substr(begin) + "/image_raw";
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
      yaml_list(k), camera.size_px[0], camera.size_px[1], yaml_text(topic_of(camera)));
}

std::string step_text(const Pose& T) {
  std::string text = "  T_cn_cnm1:\n";
  for (int r = 0; r < 3; ++r) {
    text += fmt::format("  - [{}, {}, {}, {}]\n", T.R(r, 0), T.R(r, 1), T.R(r, 2), T.t[r]);
  }
  return text + "  - [0.0, 0.0, 0.0, 1.0]\n";
}

/// Throws Error if the two poses of a camera differ by more than rounding to six digits does.
void check_agreement(const Pose& chain,
                     const Pose& by_imu,
                     double lengths_m,
                     const YamlNode& node) {
  constexpr double rounding = 1e-5;
  const double turn = vector_from_rotation(chain.R * by_imu.R.transpose()).norm();
  const double shift_m = (chain.t - by_imu.t).norm();
  if (turn <= rounding && shift_m <= rounding * lengths_m) return;
  throw Error(node.place(),
              fmt::format("T_cn_cnm1 and the T_cam_imu of the two cameras disagree by {:.3g} "
                          "degrees and {:.3g} m",
                          turn * 180 / std::numbers::pi, shift_m),
              "remove the one that is out of date");
}

/// Poses from camera to camera, from either source.
class Chain {
 public:
  explicit Chain(double unit_m) : unit_m_(unit_m) {}

  /// T_cn_cnm1 of the next camera; the identity for the first.
  Pose step(const YamlNode& node, bool first) {
    std::optional<Pose> T_imu;
    if (node.has("T_cam_imu")) T_imu = imported_pose(node.at("T_cam_imu"), unit_m_);
    Pose T;
    if (!first && T_imu && T_before_imu_) {
      T = *T_imu * T_before_imu_->inverse();
      if (node.has("T_cn_cnm1")) {
        const Pose chain = imported_pose(node.at("T_cn_cnm1"), unit_m_);
        check_agreement(chain, T, unit_m_ + T_imu->t.norm() + T_before_imu_->t.norm(), node);
        T = chain;
      } else {
        by_imu_ += (by_imu_.empty() ? "" : ", ") + node.place();
      }
    } else if (!first) {
      T = imported_pose(node.at("T_cn_cnm1"), unit_m_);
    }
    if (!T_imu && T_before_imu_) T_imu = T * *T_before_imu_;
    T_before_imu_ = T_imu;
    return T;
  }

  /// The cameras whose pose was taken from T_cam_imu; empty for none.
  const std::string& by_imu() const { return by_imu_; }

 private:
  double unit_m_;
  std::optional<Pose> T_before_imu_;  ///< of the camera before, its own or along the chain
  std::string by_imu_;
};

}  // namespace

ImportedRig read_kalibr_camchain(const std::filesystem::path& file, const ImportOptions& options) {
  const YamlNode root = YamlNode::parse(read_whole(file), file.string());
  if (!root.has("cam0")) {
    throw Error(file.string(), "is not a camchain: it has no \"cam0\"", "name another file");
  }
  ImportedRig imported;
  std::vector<PlacedCamera> cameras;
  std::set<std::string> names;
  std::vector<std::string> imu_notes;
  Chain chain(options.unit_m);
  for (std::size_t i = 0; root.has(fmt::format("cam{}", i)); ++i) {
    const YamlNode node = root.at(fmt::format("cam{}", i));
    Camera camera = camera_from_opencv(read_intrinsics(node), node.at("resolution").size_px(),
                                       node.place(), options.model);
    if (node.has("rostopic")) camera.name = camera_of_topic(node.at("rostopic").text());
    if (!camera.name.empty()) names.insert(camera.name);
    if (node.has("timeshift_cam_imu")) {
      imported.notes.push_back(node.at("timeshift_cam_imu").place() + " is ignored");
    }
    if (node.has("T_cam_imu")) imu_notes.push_back(node.at("T_cam_imu").place() + " is ignored");
    const Pose step = chain.step(node, i == 0);
    cameras.push_back({camera, i == 0 ? step : step * cameras.back().T_camera_reference});
  }
  if (!chain.by_imu().empty()) imu_notes = {chain.by_imu() + ": the pose is from T_cam_imu"};
  imported.notes.insert(imported.notes.end(), imu_notes.begin(), imu_notes.end());
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
