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

#include "calib/base/all_within.h"
#include "calib/base/joined_numbers.h"
#include "calib/base/text_lines.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "localise/trajectory.h"

namespace vernier::localise {

using vernier::internal::joined_numbers;
using vernier::internal::TextLines;

namespace {

constexpr double furthest_m = 1e9;

void check_position(const Eigen::Vector3d& t, const std::string& place) {
  if (vernier::internal::all_within(t, furthest_m)) return;
  throw Error(place, fmt::format("a position is not finite, or beyond {:g} m", furthest_m),
              "give metres");
}

Pose pose_of_tum(const std::vector<double>& v, const std::string& place) {
  const Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
  constexpr double tolerance = 1e-2;
  if (!(std::abs(q.norm() - 1) <= tolerance)) {
    throw Error(place, "the quaternion is not of length 1", "give qx qy qz qw");
  }
  return {q.normalized().toRotationMatrix(), {v[1], v[2], v[3]}};
}

Pose pose_of_kitti(std::span<const double> v, const std::string& place) {
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

/// Appends a pose that comes after those before it.
void append(const TimedPose& pose, const std::string& place, std::vector<TimedPose>& trajectory) {
  constexpr std::size_t most_poses = 10'000'000;
  if (trajectory.size() == most_poses) {
    throw Error(place, "is one of more than 10,000,000 poses", "split the file");
  }
  check_position(pose.T_world_camera.t, place);
  if (!trajectory.empty() && !(pose.time_s > trajectory.back().time_s)) {
    throw Error(place, "its time is not after that of the line before", "sort the poses");
  }
  trajectory.push_back(pose);
}

}  // namespace

std::vector<TimedPose> read_trajectory(const std::filesystem::path& file) {
  constexpr std::size_t tum_fields = 8, kitti_fields = 12;
  std::vector<TimedPose> trajectory;
  constexpr std::size_t longest_line = 100'000'000;  // matrices of a file without line ends
  TextLines lines(file, longest_line);
  std::string_view line;
  bool of_tum = false;
  while (lines.next(line)) {
    if (const std::size_t text = line.find_first_not_of(" \t\r");
        text == std::string_view::npos || line[text] == '#') {
      continue;
    }
    const std::string place = lines.place();
    const std::vector<double> v = joined_numbers(line, place);
    const bool tum = v.size() == tum_fields;
    const bool kitti = !v.empty() && v.size() % kitti_fields == 0;
    if ((!tum && !kitti) || (!trajectory.empty() && tum != of_tum)) {
      throw Error(place,
                  fmt::format("has {} fields{}", v.size(),
                              trajectory.empty() ? "" : ", lines before it another number"),
                  "give time_s x y z qx qy qz qw (TUM), or 12 numbers of a 3 x 4 matrix (KITTI)");
    }
    of_tum = tum;
    if (tum) {
      append({v[0], pose_of_tum(v, place)}, place, trajectory);
      continue;
    }
    for (std::size_t at = 0; at < v.size(); at += kitti_fields) {
      append({static_cast<double>(trajectory.size()),
              pose_of_kitti(std::span(v).subspan(at, kitti_fields), place)},
             place, trajectory);
    }
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
