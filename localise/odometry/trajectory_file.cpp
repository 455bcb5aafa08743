// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/text_lines.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "localise/trajectory.h"

namespace vernier::localise {

using vernier::internal::parse_real;
using vernier::internal::split_fields;
using vernier::internal::TextLines;

namespace {

constexpr double furthest_m = 1e9;

std::vector<double> numbers_of(const std::vector<std::string_view>& fields,
                               const std::string& place) {
  std::vector<double> numbers;
  for (const std::string_view field : fields) {
    numbers.push_back(parse_real(field, place, "field"));
    if (!std::isfinite(numbers.back())) {
      throw Error(place, "a field is not finite", "give numbers");
    }
  }
  return numbers;
}

void check_position(const Eigen::Vector3d& t, const std::string& place) {
  if (t.cwiseAbs().maxCoeff() <= furthest_m) return;
  throw Error(place, fmt::format("a position is beyond {:g} m", furthest_m), "give metres");
}

Pose pose_of_tum(const std::vector<double>& v, const std::string& place) {
  const Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
  constexpr double tolerance = 1e-2;
  if (!(std::abs(q.norm() - 1) <= tolerance)) {
    throw Error(place, "the quaternion is not of length 1", "give qx qy qz qw");
  }
  return {q.normalized().toRotationMatrix(), {v[1], v[2], v[3]}};
}

Pose pose_of_kitti(const std::vector<double>& v, const std::string& place) {
  Pose T;
  T.R << v[0], v[1], v[2], v[4], v[5], v[6], v[8], v[9], v[10];
  T.t << v[3], v[7], v[11];
  constexpr double tolerance = 1e-3;
  if (!((T.R * T.R.transpose() - Eigen::Matrix3d::Identity()).norm() <= tolerance) ||
      !(T.R.determinant() > 0)) {
    throw Error(place, "the matrix is not a rotation", "give rows of [R t], 3 x 4");
  }
  T.R = Eigen::Quaterniond(T.R).normalized().toRotationMatrix();
  return T;
}

}  // namespace

std::vector<TimedPose> read_trajectory(const std::filesystem::path& file) {
  constexpr std::size_t most_poses = 10'000'000, tum_fields = 8, kitti_fields = 12;
  std::vector<TimedPose> trajectory;
  TextLines lines(file);
  std::string_view line;
  std::size_t fields_before = 0;
  while (lines.next(line)) {
    if (const std::size_t text = line.find_first_not_of(" \t\r");
        text == std::string_view::npos || line[text] == '#') {
      continue;
    }
    const std::string place = lines.place();
    const std::vector<double> v = numbers_of(split_fields(line, " \t\r"), place);
    if ((v.size() != tum_fields && v.size() != kitti_fields) ||
        (fields_before != 0 && v.size() != fields_before)) {
      throw Error(place,
                  fmt::format("has {} fields{}", v.size(),
                              fields_before == 0 ? "" : ", lines before it another number"),
                  "give time_s x y z qx qy qz qw (TUM), or 12 numbers of a 3 x 4 matrix (KITTI)");
    }
    fields_before = v.size();
    if (trajectory.size() == most_poses) {
      throw Error(place, "is one of more than 10,000,000 poses", "split the file");
    }
    TimedPose pose;
    const bool tum = v.size() == tum_fields;
    pose.time_s = tum ? v[0] : static_cast<double>(trajectory.size());
    pose.T_world_camera = tum ? pose_of_tum(v, place) : pose_of_kitti(v, place);
    check_position(pose.T_world_camera.t, place);
    if (!trajectory.empty() && !(pose.time_s > trajectory.back().time_s)) {
      throw Error(place, "its time is not after that of the line before", "sort the poses");
    }
    trajectory.push_back(pose);
  }
  if (trajectory.empty()) {
    throw Error(file.string(), "holds no poses",
                "give lines of time_s x y z qx qy qz qw (TUM), or of 3 x 4 matrices (KITTI)");
  }
  return trajectory;
}

std::string tum_text(std::span<const TimedPose> trajectory) {
  std::string text = "# time_s x y z qx qy qz qw\n";
  for (const TimedPose& pose : trajectory) {
    const Eigen::Vector3d& t = pose.T_world_camera.t;
    Eigen::Quaterniond q(pose.T_world_camera.R);
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    text += fmt::format("{} {} {} {} {} {} {} {}\n", pose.time_s, t.x(), t.y(), t.z(), q.x(), q.y(),
                        q.z(), q.w());
  }
  return text;
}

}  // namespace vernier::localise
