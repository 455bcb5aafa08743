// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/mrcal/mrcal_parameters.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal {
namespace {

/// A free column, which moves the states `rows` by `by`.
struct StateColumn {
  std::vector<std::pair<int, double>> moves;
};

void add_camera(const Rig& rig,
                int camera,
                int first_state,
                const std::vector<bool>& held,
                std::vector<StateColumn>& columns) {
  const int ours = intrinsics_index(rig, camera);
  const int count = parameter_count(rig.cameras[camera].model);
  const bool f_held = held[ours], ax_held = held[ours + 1];
  const int fx = first_state, fy = first_state + 1;
  if (ax_held && !f_held) {
    columns.push_back({{{fx, rig.cameras[camera].ax()}, {fy, 1}}});
  } else if (!ax_held) {
    columns.push_back({{{fx, 1}}});
    if (!f_held) columns.push_back({{{fy, 1}}});
  }
  for (int k = 2; k < count; ++k) {
    if (!held[ours + k]) columns.push_back({{{first_state + k, 1}}});
  }
}

void add_pose(const Rig& rig,
              int camera,
              int first_state,
              const std::vector<bool>& held,
              std::vector<StateColumn>& columns) {
  const int ours = pose_index(rig, camera);
  for (int k = 0; k < 6; ++k) {
    if (!held[ours + k]) columns.push_back({{{first_state + k, 1}}});
  }
}

}  // namespace

Eigen::VectorXd mrcal_parameters(const Rig& rig) {
  Eigen::VectorXd theta = parameters(rig);
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const int at = intrinsics_index(rig, static_cast<int>(c));
    theta[at] = rig.cameras[c].f_px() * rig.cameras[c].ax();
    theta[at + 1] = rig.cameras[c].f_px();
  }
  return theta;
}

std::vector<std::string> mrcal_parameter_names(const Rig& rig) {
  std::vector<std::string> names = parameter_names(rig);
  const std::vector<std::string> core{"fx", "fy", "cx", "cy"},
      pose{"rx", "ry", "rz", "tx", "ty", "tz"};
  const auto rename = [&](int first, const std::vector<std::string>& words) {
    for (std::size_t k = 0; k < words.size(); ++k) {
      std::string& name = names[first + k];
      name = name.substr(0, name.find('.') + 1) + words[k];
    }
  };
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    rename(intrinsics_index(rig, static_cast<int>(c)), core);
    if (c > 0) rename(pose_index(rig, static_cast<int>(c)), pose);
  }
  return names;
}

Rig rig_from_mrcal(const Rig& like, const Eigen::VectorXd& theta) {
  Rig rig = like;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const int at = intrinsics_index(rig, static_cast<int>(c));
    Eigen::VectorXd& a = rig.cameras[c].parameters;
    a = theta.segment(at, a.size());
    a[0] = theta[at + 1];
    a[1] = theta[at] / theta[at + 1];
    if (c == 0) continue;
    const int pose = pose_index(rig, static_cast<int>(c));
    rig.T_camera_first[c] = {rotation_from_vector(theta.segment<3>(pose)),
                             theta.segment<3>(pose + 3)};
  }
  return rig;
}

Eigen::MatrixXd mrcal_by_tangent(const Rig& rig) {
  const int n = parameter_count(rig);
  Eigen::MatrixXd G = Eigen::MatrixXd::Identity(n, n);
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const int at = intrinsics_index(rig, static_cast<int>(c));
    G.block<2, 2>(at, at) << rig.cameras[c].ax(), rig.cameras[c].f_px(), 1, 0;
    if (c == 0) continue;
    const int pose = pose_index(rig, static_cast<int>(c));
    G.block<3, 3>(pose, pose) =
        left_jacobian(vector_from_rotation(rig.T_camera_first[c].R)).inverse();
  }
  return G;
}

MrcalLift mrcal_lift(const Rig& rig, const std::vector<bool>& given) {
  std::vector<bool> held = given;
  held.resize(parameter_count(rig), false);
  MrcalLift lift;
  std::vector<StateColumn> columns;
  const int lens = mrcal_lens(rig).parameters;
  int state = 0;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const CameraModel& model = rig.cameras[c].model;
    add_camera(rig, static_cast<int>(c), state, held, columns);
    for (int k = 0; k < parameter_count(model); ++k) lift.shown.push_back(state + k);
    state += lens;
  }
  for (std::size_t c = 1; c < rig.cameras.size(); ++c, state += 6) {
    add_pose(rig, static_cast<int>(c), state, held, columns);
    for (int k = 0; k < 6; ++k) lift.shown.push_back(state + k);
  }
  lift.L = Eigen::MatrixXd::Zero(state, static_cast<Eigen::Index>(columns.size()));
  for (std::size_t j = 0; j < columns.size(); ++j) {
    for (const auto& [row, by] : columns[j].moves) lift.L(row, static_cast<Eigen::Index>(j)) = by;
  }
  lift.native = lift.L.rows() == lift.L.cols();
  return lift;
}

MrcalLens mrcal_lens(const Rig& rig) {
  MrcalLens largest;
  for (const Camera& camera : rig.cameras) {
    const std::string model(model_name(camera.model));
    MrcalLens lens;
    if (model == "pinhole") lens = {"LENSMODEL_PINHOLE", parameter_count(Pinhole{})};
    if (model == "radial1" || model == "opencv4") {
      lens = {"LENSMODEL_OPENCV4", parameter_count(OpenCv4{})};
    }
    if (model == "opencv5") lens = {"LENSMODEL_OPENCV5", parameter_count(OpenCv5{})};
    if (model == "opencv8") lens = {"LENSMODEL_OPENCV8", parameter_count(OpenCv8{})};
    if (lens.name.empty()) {
      throw Error("model " + model, "mrcal has no such lens model",
                  "check pinhole, radial1, opencv4, opencv5 or opencv8");
    }
    if (lens.parameters > largest.parameters) largest = lens;
  }
  return largest;
}

}  // namespace vernier::internal
