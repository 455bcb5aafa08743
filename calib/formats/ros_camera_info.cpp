// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/formats/ros_camera_info.h"

#include <fmt/format.h>

#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

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

struct DistortionModel {
  const char* name;
  std::size_t least, most;
  bool fisheye;
};
// some drivers call equidistant kannala_brandt
constexpr DistortionModel distortion_models[] = {{"plumb_bob", 0, 5, false},
                                                 {"rational_polynomial", 8, 14, false},
                                                 {"equidistant", 4, 4, true},
                                                 {"fisheye", 4, 4, true},
                                                 {"kannala_brandt", 4, 4, true}};

void read_distortion(const YamlNode& root, OpenCvIntrinsics& in) {
  const YamlNode coefficients = root.at_any({"distortion_coefficients", "D", "d"});
  in.coefficients = coefficients.vector();
  const YamlNode model = root.at("distortion_model");
  for (const DistortionModel& known : distortion_models) {
    if (model.text() != known.name) continue;
    in.fisheye = known.fisheye;
    const std::size_t n = in.coefficients.size();
    const bool odd = !known.fisheye && n != 0 && n != 4 && n != 5 && n != 8 && n != 12 && n != 14;
    if (n < known.least || n > known.most || odd) {
      throw Error(coefficients.place(),
                  fmt::format("holds {} coefficients, not a number that {} has", n, known.name),
                  "plumb_bob has 4 or 5, rational_polynomial 8, equidistant 4");
    }
    return;
  }
  throw Error(model.place(), "unsupported distortion model " + in_quotes(model.text()),
              "supported: plumb_bob, rational_polynomial, equidistant");
}

/// Position of the rectified camera relative to the common one, in metres of the file: t of P = K'
/// [I | t].
Eigen::Vector3d rectified_shift(const RosCameraInfo& info, const std::string& place) {
  const auto& P = info.P;
  if (P.isZero()) return Eigen::Vector3d::Zero();
  if (!(P(0, 0) > 0 && P(1, 1) > 0) || P(2, 2) != 1 || P(2, 3) != 0) {
    throw Error(place + ": projection_matrix", "is not K' [I | t] with t_z = 0", "correct it");
  }
  return {P(0, 3) / P(0, 0), P(1, 3) / P(1, 1), 0};
}

/// Binning and a region of interest that is not the whole image.
std::vector<std::string> not_applied(const YamlNode& root, const Eigen::Vector2i& size_px) {
  std::vector<std::string> keys;
  const auto add = [&](const YamlNode& node, const char* key, double above, double below) {
    if (!node.has(key)) return;
    const double value = node.at(key).number();
    if (value > above && value < below) keys.push_back(node.at(key).place());
  };
  constexpr double any = std::numeric_limits<double>::infinity();
  add(root, "binning_x", 1, any);
  add(root, "binning_y", 1, any);
  if (!root.has("roi")) return keys;
  const YamlNode roi = root.at("roi");
  add(roi, "x_offset", 0, any);
  add(roi, "y_offset", 0, any);
  add(roi, "width", 0, size_px.x());
  add(roi, "height", 0, size_px.y());
  return keys;
}

std::string array_text(const char* key, Eigen::Index rows, Eigen::Index cols, std::string data) {
  return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: [{}]\n", key, rows, cols, data);
}

}  // namespace

RosCameraInfo parse_ros_camera_info(const std::string& text,
                                    const std::string& place,
                                    const ImportOptions& options) {
  const YamlNode root = YamlNode::parse(text, place);
  const YamlNode matrix = root.at_any({"camera_matrix", "K", "k"});
  OpenCvIntrinsics in = intrinsics_of_camera_matrix(matrix.matrix(3, 3), matrix.place());
  read_distortion(root, in);
  const Eigen::Vector2i size{root.at_any({"image_width", "width"}).count(),
                             root.at_any({"image_height", "height"}).count()};
  RosCameraInfo info;
  info.camera = camera_from_opencv(in, size, matrix.place(), options.model);
  if (root.has("camera_name")) info.camera.name = root.at("camera_name").text();
  if (root.has("rectification_matrix") || root.has("R") || root.has("r")) {
    const YamlNode R = root.at_any({"rectification_matrix", "R", "r"});
    const Eigen::Matrix3d value = R.matrix(3, 3);
    // all zeros: never set
    if (!value.isZero()) info.R_rectified_camera = nearest_rotation(value, R.place());
  }
  if (root.has("projection_matrix") || root.has("P") || root.has("p")) {
    info.P = root.at_any({"projection_matrix", "P", "p"}).matrix(3, 4);
  }
  info.not_applied = not_applied(root, size);
  return info;
}

ImportedRig read_ros_camera_info(const std::vector<std::filesystem::path>& files,
                                 const ImportOptions& options) {
  if (files.size() > 2) {
    throw Error(files[2].string(), "a camera_info has no poses, only a pair's rectification",
                "give one file or the two of a pair");
  }
  std::vector<RosCameraInfo> infos;
  std::vector<Eigen::Vector3d> shifts;
  for (const std::filesystem::path& file : files) {
    infos.push_back(parse_ros_camera_info(read_whole(file), file.string(), options));
    if (infos.back().camera.name.empty()) infos.back().camera.name = file.stem().string();
    shifts.push_back(translation(rectified_shift(infos.back(), file.string()), options.unit_m,
                                 file.string() + ": projection_matrix"));
  }
  std::vector<PlacedCamera> cameras{{infos[0].camera, Pose{}}};
  if (infos.size() == 2) {
    const Eigen::Vector3d t = shifts[1] - shifts[0];
    if (t.isZero()) {
      throw Error(files[1].string() + ": projection_matrix",
                  "has no baseline, so the files do not give the cameras' poses",
                  "give the camera_info of a calibrated pair, the left one first");
    }
    const Eigen::Matrix3d R_right_rectified = infos[1].R_rectified_camera.transpose();
    cameras.push_back({infos[1].camera,
                       {R_right_rectified * infos[0].R_rectified_camera, R_right_rectified * t}});
  }
  ImportedRig imported{rig_of(std::move(cameras)), {}};
  for (const RosCameraInfo& info : infos) {
    for (const std::string& key : info.not_applied) {
      imported.notes.push_back(key + " is ignored: the rig is that of whole images");
    }
  }
  return imported;
}

ExportedFile format_ros_camera_info(const RosCameraInfo& info) {
  const Camera& camera = info.camera;
  const OpenCvIntrinsics in = opencv_intrinsics(camera);
  const bool rational = in.coefficients.size() == 8;
  const std::vector<double> k = held_coefficients(camera,
                                                  in.fisheye ? 4
                                                  : rational ? 8
                                                             : 5,
                                                  "CameraInfo");
  return {file_stem(camera) + ".yaml",
          fmt::format("image_width: {}\nimage_height: {}\ncamera_name: {}\n", camera.size_px[0],
                      camera.size_px[1], yaml_text(camera.name)) +
              array_text("camera_matrix", 3, 3, yaml_list(Eigen::MatrixXd(camera_matrix(in)))) +
              fmt::format("distortion_model: {}\n", in.fisheye ? "equidistant"
                                                    : rational ? "rational_polynomial"
                                                               : "plumb_bob") +
              array_text("distortion_coefficients", 1, static_cast<Eigen::Index>(k.size()),
                         yaml_list(k)) +
              array_text("rectification_matrix", 3, 3,
                         yaml_list(Eigen::MatrixXd(info.R_rectified_camera))) +
              array_text("projection_matrix", 3, 4, yaml_list(Eigen::MatrixXd(info.P)))};
}

}  // namespace vernier::internal
