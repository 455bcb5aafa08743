// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/formats/colmap_cameras.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <variant>

#include "calib/base/shown_text.h"
#include "calib/camera.h"
#include "calib/camera/opencv_intrinsics.h"
#include "calib/error.h"
#include "calib/formats/colmap_poses.h"
#include "calib/formats/imported_rig.h"
#include "calib/formats/rig_json.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal {
namespace {

using colmap::Line;

/// Layout of a COLMAP model's parameters. Core: fx fy cx cy by index.
struct Model {
  const char* name;
  int core[4];
  std::size_t coefficients;
  bool fisheye;
};
constexpr Model models[] = {{"SIMPLE_PINHOLE", {0, 0, 1, 2}, 0, false},
                            {"PINHOLE", {0, 1, 2, 3}, 0, false},
                            {"SIMPLE_RADIAL", {0, 0, 1, 2}, 1, false},
                            {"RADIAL", {0, 0, 1, 2}, 2, false},
                            {"OPENCV", {0, 1, 2, 3}, 4, false},
                            {"FULL_OPENCV", {0, 1, 2, 3}, 8, false},
                            {"SIMPLE_RADIAL_FISHEYE", {0, 0, 1, 2}, 1, true},
                            {"RADIAL_FISHEYE", {0, 0, 1, 2}, 2, true},
                            {"OPENCV_FISHEYE", {0, 1, 2, 3}, 4, true}};

const Model& find_model(const std::string& name, const std::string& place) {
  for (const Model& model : models) {
    if (name == model.name) return model;
  }
  throw Error(place, "unsupported camera model " + shortened(name),
              "supported: PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV, OPENCV_FISHEYE and "
              "their simpler forms");
}

Camera read_camera(const Line& line, const ImportOptions& options) {
  const Model& model = find_model(line.word(1), line.place());
  const std::size_t core = static_cast<std::size_t>(model.core[3]) + 1;
  line.check_count(4 + core + model.coefficients);
  const auto value = [&](std::size_t i) { return line.number(4 + i); };
  OpenCvIntrinsics in{value(model.core[0]),       value(model.core[1]), value(model.core[2]) - 0.5,
                      value(model.core[3]) - 0.5, model.fisheye,        {}};
  for (std::size_t i = 0; i < model.coefficients; ++i) in.coefficients.push_back(value(core + i));
  if (model.fisheye) in.coefficients.resize(4, 0.0);
  return camera_from_opencv(in, {line.whole(2), line.whole(3)}, line.place(), options.model);
}

std::string model_line(const Camera& camera) {
  const OpenCvIntrinsics in = opencv_intrinsics(camera);
  const double cx = in.cx_px + 0.5, cy = in.cy_px + 0.5;
  if (std::holds_alternative<Radial1>(camera.model) && camera.ax() == 1) {
    return fmt::format("SIMPLE_RADIAL {} {} {} {} {} {}", camera.size_px[0], camera.size_px[1],
                       in.fx_px, cx, cy, in.coefficients[0]);
  }
  const std::size_t n = in.coefficients.size();
  const std::vector<double> k = held_coefficients(camera, n > 4 ? 8 : n, "FULL_OPENCV");
  return fmt::format("{} {} {} {} {} {} {}{}{}",
                     in.fisheye ? "OPENCV_FISHEYE"
                     : n > 4    ? "FULL_OPENCV"
                     : n > 0    ? "OPENCV"
                                : "PINHOLE",
                     camera.size_px[0], camera.size_px[1], in.fx_px, in.fy_px, cx, cy,
                     n > 0 ? " " : "", fmt::join(k, " "));
}

const std::string& plain_name(const Camera& camera) {
  if (camera.name.find(' ') != std::string::npos) {
    throw Error("camera \"" + camera.name + "\"", "COLMAP's names cannot contain blanks",
                "rename it");
  }
  return file_stem(camera);
}

/// w x y z, with w >= 0.
std::array<double, 4> quaternion(const Eigen::Matrix3d& R) {
  Eigen::Quaterniond q(R);
  q.normalize();
  const double sign = q.w() < 0 ? -1 : 1;
  return {sign * q.w(), sign * q.x(), sign * q.y(), sign * q.z()};
}

std::string rig_config_entry(const Camera& camera, const Pose& T, bool first) {
  const std::string line = model_line(camera);  // MODEL WIDTH HEIGHT PARAMS
  std::vector<std::string> words;
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t end = std::min(line.find(' ', at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end + 1;
  }
  const std::string pose = first ? "\"ref_sensor\": true"
                                 : fmt::format(
                                       "\"cam_from_rig_rotation\": [{}],\n        "
                                       "\"cam_from_rig_translation\": [{}, {}, {}]",
                                       fmt::join(quaternion(T.R), ", "), T.t[0], T.t[1], T.t[2]);
  constexpr auto replace =
      rig_json::Json::error_handler_t::replace;  // a name may contain any bytes
  return fmt::format(
      "      {{\n        \"image_prefix\": {},\n        {},\n        "
      "\"camera_model_name\": \"{}\",\n        \"camera_params\": [{}]\n      }}",
      rig_json::Json(camera.name + "/").dump(-1, ' ', false, replace), pose, words[0],
      fmt::join(words.begin() + 3, words.end(), ", "));
}

}  // namespace

ImportedRig read_colmap_cameras(const std::filesystem::path& file_or_folder,
                                const ImportOptions& options) {
  const std::filesystem::path file = std::filesystem::is_directory(file_or_folder)
                                         ? file_or_folder / "cameras.txt"
                                         : file_or_folder;
  std::vector<Line> lines = colmap::read_lines(file);
  std::map<int, Camera> cameras;
  for (const Line& line : lines) {
    if (!cameras.emplace(line.whole(0), read_camera(line, options)).second) {
      throw Error(line.place(), fmt::format("camera {} appears twice", line.whole(0)),
                  "keep one of them");
    }
  }
  if (cameras.empty()) throw Error(file.string(), "holds no camera", "name another file");
  std::sort(lines.begin(), lines.end(),
            [](const Line& a, const Line& b) { return a.whole(0) < b.whole(0); });

  ImportedRig imported;
  std::vector<PlacedCamera> placed;
  for (const auto& p : colmap::read_poses(file, lines, options.unit_m, imported.notes)) {
    placed.push_back({cameras.at(p.id), p.T_camera_reference});
    placed.back().camera.name = p.name;
  }
  imported.rig = rig_of(std::move(placed));
  return imported;
}

std::vector<ExportedFile> colmap_cameras(const Rig& rig) {
  std::string cameras = "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]; (0, 0) is a pixel's corner\n";
  std::string images =
      "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME: each stands for the pose of a camera\n";
  std::string config;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    const Pose& T = rig.T_camera_first[i];
    const std::string& name = plain_name(rig.cameras[i]);
    cameras += fmt::format("{} {}\n", i + 1, model_line(rig.cameras[i]));
    images += fmt::format("{0} {1} {2} {3} {4} {0} {5}/rig.png\n\n", i + 1,
                          fmt::join(quaternion(T.R), " "), T.t[0], T.t[1], T.t[2], name);
    config += (i ? ",\n" : "") + rig_config_entry(rig.cameras[i], T, i == 0);
  }
  return {{"cameras.txt", cameras},
          {"images.txt", images},
          {"points3D.txt", "# none\n"},
          {"rig_config.json", "[\n  {\n    \"cameras\": [\n" + config + "\n    ]\n  }\n]\n"}};
}

}  // namespace vernier::internal
