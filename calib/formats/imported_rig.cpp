// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/formats/imported_rig.h"

#include <fmt/format.h>

#include <Eigen/SVD>

#include "calib/base/all_within.h"
#include "calib/camera.h"
#include "calib/camera/rig_limits.h"
#include "calib/error.h"
#include "calib/formats/yaml_node.h"
#include "calib/pose.h"

namespace vernier::internal {

const std::string& file_stem(const Camera& camera) {
  const std::string& name = camera.name;
  bool plain = !name.empty() && name[0] != '.';
  for (const char c : name) {
    plain = plain && c != '/' && c != '\\' && static_cast<unsigned char>(c) >= 0x20 && c != 0x7f;
  }
  if (!plain) {
    throw Error(fmt::format("camera \"{}\"", name), "its name is not valid as a file name",
                "rename the cameras, as convert --names left,right does");
  }
  return name;
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& M, const std::string& place) {
  const double deviation = (M.transpose() * M - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  constexpr double most_rounding = 5e-6;  // of entries with six decimals
  if (!(deviation <= most_rounding)) {
    throw Error(place,
                fmt::format("is not a rotation: it deviates from orthonormal by {:.2g}", deviation),
                fmt::format("correct it; {:g} is allowed", most_rounding));
  }
  if (M.determinant() < 0) {
    throw Error(place, "is a reflection, not a rotation: its determinant is -1", "correct it");
  }
  if (deviation <= 1e-14) return M;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

Eigen::Vector3d translation(const Eigen::Vector3d& t, double unit_m, const std::string& place) {
  const Eigen::Vector3d t_m = unit_m * t;
  if (!all_within(t_m, most_value)) {
    throw Error(place, fmt::format("a position is not finite, or beyond {:g} m", most_value),
                "correct it, or the unit of length");
  }
  return t_m;
}

Pose imported_pose(const YamlNode& matrix, double unit_m) {
  const Eigen::Matrix4d T = matrix.matrix(4, 4);
  if (T.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    throw Error(matrix.place(), "its last row is not 0 0 0 1", "correct it");
  }
  return {nearest_rotation(T.topLeftCorner<3, 3>(), matrix.place()),
          translation(T.topRightCorner<3, 1>(), unit_m, matrix.place())};
}

}  // namespace vernier::internal
