// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "calib/base/all_within.h"
#include "calib/base/shown_text.h"
#include "calib/camera.h"
#include "calib/camera/rig_limits.h"
#include "calib/error.h"
#include "calib/formats/rig_json.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal::rig_json {
namespace {

/// Of a rotation vector, whose length needs π only.
constexpr double most_rotation_rad = 100;

Json camera_json(const Camera& camera, const Pose& T_camera_first, bool first) {
  Json json;
  json["name"] = camera.name;
  json["model"] = model_name(camera.model);
  json["size_px"] = {camera.size_px[0], camera.size_px[1]};
  const std::vector<std::string> names = parameter_names(camera.model);
  for (std::size_t i = 0; i < names.size(); ++i) {
    json["parameters"][names[i]] = camera.parameters[static_cast<Eigen::Index>(i)];
    if (names[i] == "ax") json["parameters"]["ay"] = 1;
  }
  if (!first) {
    json["from_first"]["rotation_rad"] =
        to_json(Eigen::VectorXd(vector_from_rotation(T_camera_first.R)));
    json["from_first"]["translation_m"] = to_json(Eigen::VectorXd(T_camera_first.t));
  }
  return json;
}

/// A camera's name is part of the names of its parameters.
std::string parse_name(const Node& node) {
  const std::string name = node.text();
  if (is_camera_name(name)) return name;
  throw Error(node.place(), in_quotes(name) + " is not a camera's name",
              fmt::format("use up to {} letters on one line", most_name_bytes));
}

Camera parse_camera(const Node& node) {
  Camera camera;
  camera.name = parse_name(node.at("name"));
  const Node model = node.at("model");
  const std::string wanted = model.text();
  try {
    camera.model = camera_model(wanted);
  } catch (const Error& error) {
    throw Error(model.place(), error.place() + ": " + error.fault(), error.remedy());
  }
  const Eigen::VectorXd size = node.at("size_px").vector();
  const bool whole = size.size() == 2 && size == size.array().round().matrix();
  if (!whole || !(size.minCoeff() >= 1) || !(size.maxCoeff() <= most_side_px)) {
    throw Error(node.at("size_px").place(), "is not [width, height]",
                "give two whole numbers of 1 to 1,000,000");
  }
  camera.size_px = size.cast<int>();
  const Node values = node.at("parameters");
  if (values.has("ay") && values.at("ay").number() != 1) {
    throw Error(values.at("ay").place(),
                "is not 1: (f, ax, ay) together have a null direction, so ay is 1 by definition",
                "multiply f_px by ay and divide ax by it");
  }
  const std::vector<std::string> names = parameter_names(camera.model);
  camera.parameters.resize(static_cast<Eigen::Index>(names.size()));
  for (std::size_t i = 0; i < names.size(); ++i) {
    camera.parameters[static_cast<Eigen::Index>(i)] = values.at(names[i]).number();
  }
  for (const auto& [key, value] : values.json().items()) {
    if (key != "ay" && std::find(names.begin(), names.end(), key) == names.end()) {
      throw Error(values.place() + "." + shortened(key),
                  fmt::format("the model {} has no such parameter", model_name(camera.model)),
                  "remove it or choose another model");
    }
  }
  if (!(camera.f_px() > 0) || !(camera.ax() > 0)) {
    throw Error(values.place(), "f_px and ax must be above 0", "");
  }
  check_bounded(camera.parameters, most_value, values);
  if (camera.ax() > most_focal_ratio || camera.ax() < 1 / most_focal_ratio) {
    throw Error(values.at("ax").place(), fmt::format("is {}", camera.ax()),
                fmt::format("the focal lengths may differ by a factor of {}", most_focal_ratio));
  }
  return camera;
}

}  // namespace

void check_bounded(const Eigen::MatrixXd& values, double most, const Node& node) {
  if (all_within(values, most)) return;
  throw Error(node.place(), fmt::format("holds a number beyond {:g}", most), "correct it");
}

Rig parse_cameras(const Node& node) {
  Rig rig;
  std::set<std::string> names;
  if (node.array().size() > most_cameras) {
    throw Error(node.place(), fmt::format("it has {} cameras", node.size()),
                fmt::format("a rig file may have {}", most_cameras));
  }
  for (std::size_t i = 0; i < node.array().size(); ++i) {
    const Node camera = node.at(i);
    rig.cameras.push_back(parse_camera(camera));
    if (!names.insert(rig.cameras.back().name).second) {
      throw Error(camera.at("name").place(), "two cameras have this name",
                  "give each its own name");
    }
    Pose T;
    if (i > 0) {
      const Node pose = camera.at("from_first");
      const Eigen::Vector3d rotation_rad = pose.at("rotation_rad").vector3();
      T = {rotation_from_vector(rotation_rad), pose.at("translation_m").vector3()};
      check_bounded(rotation_rad, most_rotation_rad, pose.at("rotation_rad"));
      check_bounded(T.t, most_value, pose.at("translation_m"));
    }
    rig.T_camera_first.push_back(T);
  }
  if (rig.cameras.empty()) throw Error(node.place(), "it has no camera", "");
  return rig;
}

Json cameras_json(const Rig& rig) {
  Json json = Json::array();
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    json.push_back(camera_json(rig.cameras[i], rig.T_camera_first[i], i == 0));
  }
  return json;
}

}  // namespace vernier::internal::rig_json
