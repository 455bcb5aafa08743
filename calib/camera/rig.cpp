// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <set>
#include <utility>

#include "calib/base/all_within.h"
#include "calib/base/shown_text.h"
#include "calib/camera.h"
#include "calib/camera/rig_limits.h"
#include "calib/camera/same_lens_models.h"
#include "calib/error.h"
#include "calib/pose.h"

namespace vernier {

namespace {

/// Throws Error unless least <= camera <= number of cameras, which stands for the end.
void check_index(const Rig& rig, int camera, int least) {
  if (camera >= least && camera <= static_cast<int>(rig.cameras.size())) return;
  throw Error("rig", fmt::format("no such camera: {} of {}", camera, rig.cameras.size()),
              least == 0 ? "count from 0" : "count from 0; the first camera has no pose");
}

/// Throws Error unless every camera has a pose, and the parameters of its model.
void check_complete(const Rig& rig) {
  for (const Camera& camera : rig.cameras) check_parameters(camera);
  if (rig.cameras.size() <= 1 || rig.T_camera_first.size() == rig.cameras.size()) return;
  throw Error("rig",
              fmt::format("{} poses for {} cameras", rig.T_camera_first.size(), rig.cameras.size()),
              "give one a camera, the first the identity");
}

}  // namespace

int intrinsics_index(const Rig& rig, int camera) {
  check_index(rig, camera, 0);
  int index = 0;
  for (int i = 0; i < camera; ++i) index += parameter_count(rig.cameras[i].model);
  return index;
}

int pose_index(const Rig& rig, int camera) {
  check_index(rig, camera, 1);
  return intrinsics_index(rig, static_cast<int>(rig.cameras.size())) + 6 * (camera - 1);
}

int parameter_count(const Rig& rig) {
  if (rig.cameras.empty()) return 0;
  return pose_index(rig, static_cast<int>(rig.cameras.size()));
}

std::vector<std::string> parameter_names(const Rig& rig) {
  std::vector<std::string> names;
  for (const Camera& camera : rig.cameras) {
    for (const std::string& name : parameter_names(camera.model)) {
      names.push_back(camera.name + "." + name);
    }
  }
  for (std::size_t i = 1; i < rig.cameras.size(); ++i) {
    for (const char* name : {"wx_rad", "wy_rad", "wz_rad", "tx_m", "ty_m", "tz_m"}) {
      names.push_back(rig.cameras[i].name + "." + name);
    }
  }
  return names;
}

Eigen::VectorXd parameters(const Rig& rig) {
  check_complete(rig);
  Eigen::VectorXd a(parameter_count(rig));
  int index = 0;
  for (const Camera& camera : rig.cameras) {
    a.segment(index, camera.parameters.size()) = camera.parameters;
    index += static_cast<int>(camera.parameters.size());
  }
  for (std::size_t i = 1; i < rig.cameras.size(); ++i, index += 6) {
    a.segment<3>(index) = vector_from_rotation(rig.T_camera_first[i].R);
    a.segment<3>(index + 3) = rig.T_camera_first[i].t;
  }
  return a;
}

Rig retract(const Rig& rig, const Eigen::VectorXd& delta) {
  check_complete(rig);
  if (delta.size() != parameter_count(rig)) {
    throw Error("rig",
                fmt::format("{} changes for {} parameters", delta.size(), parameter_count(rig)),
                "give one a parameter, in the order of parameter_names");
  }
  Rig moved = rig;
  int index = 0;
  for (Camera& camera : moved.cameras) {
    camera.parameters += delta.segment(index, camera.parameters.size());
    index += static_cast<int>(camera.parameters.size());
  }
  for (std::size_t i = 1; i < rig.cameras.size(); ++i, index += 6) {
    moved.T_camera_first[i] = retract(rig.T_camera_first[i], delta.segment<6>(index));
  }
  return moved;
}

Eigen::VectorXd difference(const Rig& to, const Rig& from) {
  if (!internal::same_lens_models(from, to)) {
    throw Error("rig", "the rigs differ in their number of cameras, or in a lens model",
                "give two rigs of the same cameras and models");
  }
  Eigen::VectorXd delta = parameters(to) - parameters(from);
  for (std::size_t i = 1; i < from.cameras.size(); ++i) {
    delta.segment<3>(pose_index(from, static_cast<int>(i))) =
        vector_from_rotation(to.T_camera_first[i].R * from.T_camera_first[i].R.transpose());
  }
  return delta;
}

std::string default_camera_name(std::size_t index) {
  return index == 0 ? "left" : index == 1 ? "right" : "camera" + std::to_string(index);
}

Rig rig_of(std::vector<PlacedCamera> cameras) {
  if (cameras.size() > internal::most_cameras) {
    throw Error("rig", fmt::format("it has {} cameras", cameras.size()),
                fmt::format("a rig may have {}", internal::most_cameras));
  }
  std::set<std::string> names;
  bool distinct = true;
  for (const PlacedCamera& c : cameras) {
    if (!internal::is_camera_name(c.camera.name)) {
      throw Error("camera " + internal::in_quotes(c.camera.name),
                  "its name is longer than 100 bytes, not on one line or not UTF-8", "rename it");
    }
    distinct = distinct && !c.camera.name.empty() && names.insert(c.camera.name).second;
  }
  Rig rig;
  for (PlacedCamera& c : cameras) {
    if (!distinct) c.camera.name = default_camera_name(rig.cameras.size());
    rig.T_camera_first.push_back(rig.cameras.empty() ? Pose{}
                                                     : c.T_camera_reference *
                                                           cameras[0].T_camera_reference.inverse());
    if (!internal::all_within(rig.T_camera_first.back().t, internal::most_value)) {
      throw Error("camera " + internal::in_quotes(c.camera.name),
                  fmt::format("it is further than {:g} m from the first", internal::most_value),
                  "correct its position, or the unit of length");
    }
    rig.cameras.push_back(std::move(c.camera));
  }
  return rig;
}

bool internal::same_lens_models(const Rig& a, const Rig& b) {
  return std::equal(
      a.cameras.begin(), a.cameras.end(), b.cameras.begin(), b.cameras.end(),
      [](const Camera& x, const Camera& y) { return x.model.index() == y.model.index(); });
}

}  // namespace vernier
