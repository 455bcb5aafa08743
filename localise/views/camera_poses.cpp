// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/views/camera_poses.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "calib/base/shown_text.h"
#include "calib/base/text_lines.h"
#include "calib/error.h"
#include "calib/formats/colmap_poses.h"
#include "calib/formats/imported_rig.h"
#include "calib/pose.h"
#include "localise/trajectory.h"
#include "localise/views/image_names.h"

namespace vernier::localise::internal {

using namespace vernier::internal;

namespace {

constexpr std::size_t most_poses = 1'000'000;
constexpr double nanoseconds = 1e-9;

std::size_t first_of_text(std::string_view line) { return line.find_first_not_of(" \t\r"); }

/// A pose from a file. Throws Error(`place`) for a position out of range.
Pose checked_pose(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, const std::string& place) {
  return {R, translation(t, 1, place)};
}

/// The first line that is not blank; a comment counts.
std::string first_line(const std::filesystem::path& file) {
  TextLines lines(file, 100'000'000);
  std::string_view line;
  while (lines.next(line)) {
    if (first_of_text(line) != std::string_view::npos) return std::string(line);
  }
  return "";
}

CameraPoses read_asl(const std::filesystem::path& file) {
  CameraPoses read;
  read.of_body = true;
  TextLines lines(file);
  std::string_view line;
  while (lines.next(line)) {
    const std::size_t first = first_of_text(line);
    if (first == std::string_view::npos || line[first] == '#') continue;
    const std::string place = lines.place();
    constexpr std::size_t least = 8;
    const std::vector<std::string_view> fields = split_fields(line, ", \t\r");
    if (fields.size() < least) {
      throw Error(place, fmt::format("has {} fields", fields.size()),
                  "give timestamp_ns, x, y, z, qw, qx, qy, qz");
    }
    double v[least];
    for (std::size_t i = 0; i < least; ++i) {
      v[i] = parse_real(fields[i], place, "field");
      if (!std::isfinite(v[i])) throw Error(place, "a field is not finite", "give numbers");
    }
    const Eigen::Quaterniond q(v[4], v[5], v[6], v[7]);
    if (!(std::abs(q.norm() - 1) <= 1e-2)) {
      throw Error(place, "the quaternion is not of length 1", "give qw, qx, qy, qz");
    }
    const double time_s = nanoseconds * v[0];
    if (!read.poses.empty() && !(time_s > *read.poses.back().time_s)) {
      throw Error(place, "its time is not after that of the line before", "sort the poses");
    }
    if (read.poses.size() == most_poses) {
      throw Error(place, "is one of more than 1,000,000 poses", "split the file");
    }
    read.poses.push_back(
        {"", time_s, checked_pose(q.normalized().toRotationMatrix(), {v[1], v[2], v[3]}, place)});
  }
  return read;
}

/// Lines of an image's name and a 4 x 4 matrix by rows.
CameraPoses read_matrices(const std::filesystem::path& file) {
  CameraPoses read;
  std::set<std::string> names;
  TextLines lines(file);
  std::string_view line;
  lines.next(line);  // the header
  while (lines.next(line)) {
    if (first_of_text(line) == std::string_view::npos) continue;
    const std::string place = lines.place();
    constexpr std::size_t fields_of_line = 17;
    const std::vector<std::string_view> fields = split_fields(line, ",");
    if (fields.size() != fields_of_line) {
      throw Error(place, fmt::format("has {} fields, not 17", fields.size()),
                  "give the image's name and a 4 x 4 matrix by rows");
    }
    Eigen::Matrix4d T;
    for (std::size_t i = 1; i < fields_of_line; ++i) {
      T(static_cast<Eigen::Index>((i - 1) / 4), static_cast<Eigen::Index>((i - 1) % 4)) =
          parse_real(fields[i], place, "entry");
    }
    const Eigen::Matrix3d M = T.topLeftCorner<3, 3>();
    constexpr double tolerance = 1e-3;
    if (!((M * M.transpose() - Eigen::Matrix3d::Identity()).norm() <= tolerance) ||
        !(M.determinant() > 0) || T.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
      throw Error(place, "is not a pose [R t; 0 0 0 1]", "give camera to world, by rows");
    }
    std::string name = std::filesystem::path(fields[0]).lexically_normal().string();
    const bool is_file = !std::filesystem::path(name).filename().empty();
    if (!is_file || !names.insert(name).second) {
      throw Error(place, is_file ? "names its image a second time" : "names no image",
                  "name each image once");
    }
    if (read.poses.size() == most_poses) {
      throw Error(place, "is one of more than 1,000,000 poses", "split the file");
    }
    read.poses.push_back({std::move(name),
                          {},
                          checked_pose(Eigen::Quaterniond(M).normalized().toRotationMatrix(),
                                       T.topRightCorner<3, 1>(), place)});
  }
  return read;
}

CameraPoses read_colmap(const std::filesystem::path& file) {
  CameraPoses read;
  std::set<std::string> names;
  for (const colmap::Line& line : colmap::read_lines(file, true)) {
    if (line.size() < 10) line.check_count(10);
    std::string name = line.word(9);
    if (!names.insert(name).second) {
      throw Error(line.place(), "names its image a second time", "name each image once");
    }
    const Pose T = colmap::pose(line, 1, 1).inverse();
    read.poses.push_back({std::move(name), {}, checked_pose(T.R, T.t, line.place())});
  }
  return read;
}

std::filesystem::path colmap_images(const std::filesystem::path& folder) {
  std::error_code fault;
  if (std::filesystem::is_regular_file(folder / "images.txt", fault)) return folder / "images.txt";
  const bool binary = std::filesystem::exists(folder / "images.bin", fault);
  throw Error(folder.string(),
              binary ? "holds a COLMAP model in binary form, which is not read"
                     : "is a folder without an images.txt",
              binary ? "write it as text: colmap model_converter --output_type TXT"
                     : "give a file of poses, or the folder of a COLMAP model");
}

Pose interpolated(const CameraPose& a, const CameraPose& b, double time_s) {
  const double u = (time_s - *a.time_s) / (*b.time_s - *a.time_s);
  const Eigen::Quaterniond from(a.T_world_camera.R), to(b.T_world_camera.R);
  return {from.slerp(u, to).normalized().toRotationMatrix(),
          (1 - u) * a.T_world_camera.t + u * b.T_world_camera.t};
}

Pose pose_at(const CameraPoses& poses,
             double time_s,
             double gap_s,
             const std::string& place,
             const std::string& image) {
  const auto after =
      std::lower_bound(poses.poses.begin(), poses.poses.end(), time_s,
                       [](const CameraPose& pose, double time) { return *pose.time_s < time; });
  if (after != poses.poses.end() && *after->time_s == time_s) return after->T_world_camera;
  if (after == poses.poses.begin() || after == poses.poses.end() ||
      *after->time_s - *(after - 1)->time_s > gap_s) {
    throw Error(place, fmt::format("has no pose at the time of {}", image),
                "leave the image out, or give the poses of the time");
  }
  return interpolated(*(after - 1), *after, time_s);
}

/// Whether the times only count the poses, as those of KITTI's files, and images have another
/// clock.
bool only_count(const CameraPoses& poses, const std::vector<double>& image_times_s) {
  double counted = 0;
  for (const CameraPose& pose : poses.poses) {
    if (pose.time_s != counted++) return false;
  }
  return std::none_of(image_times_s.begin(), image_times_s.end(),
                      [&](double time_s) { return time_s <= counted; });
}

std::optional<std::vector<Pose>> by_time(const CameraPoses& poses,
                                         const std::vector<std::filesystem::path>& images,
                                         const std::string& place,
                                         double gap_s) {
  if (poses.poses.empty() || !poses.poses[0].time_s) return {};
  std::vector<double> times_s;
  for (const std::filesystem::path& image : images) {
    // 1305031102.175304.png: the ending is the last part
    const std::optional<double> time_s = time_of_name(image.stem().string());
    if (!time_s) return {};
    times_s.push_back(*time_s);
  }
  if (only_count(poses, times_s)) return {};
  std::vector<Pose> found;
  for (std::size_t i = 0; i < images.size(); ++i) {
    found.push_back(pose_at(poses, times_s[i], gap_s, place, images[i].filename().string()));
  }
  return found;
}

}  // namespace

std::optional<double> time_of_name(const std::string& stem) {
  constexpr std::size_t digits_of_nanoseconds = 16;
  if (stem.empty() || !is_digit(stem[0])) return {};
  const std::optional<double> value = to_finite(stem);
  if (!value) return {};
  const bool whole = stem.find_first_not_of("0123456789") == std::string::npos;
  if (!whole) return *value;
  return stem.size() >= digits_of_nanoseconds ? std::optional(nanoseconds * *value) : std::nullopt;
}

CameraPoses read_camera_poses(const std::filesystem::path& file_or_folder) {
  std::error_code fault;
  const bool folder = std::filesystem::is_directory(file_or_folder, fault);
  const std::filesystem::path file = folder ? colmap_images(file_or_folder) : file_or_folder;
  if (file.filename() == "images.bin") colmap_images(file.parent_path());
  CameraPoses read;
  const std::string head = first_line(file);
  if (file.filename() == "images.txt") {
    read = read_colmap(file);
  } else if (head.starts_with("frame,t00,") || head.starts_with("image,t00,")) {
    read = read_matrices(file);
  } else if (head.starts_with("#timestamp") && head.find(',') != std::string::npos) {
    read = read_asl(file);
  } else {
    for (const TimedPose& pose : read_trajectory(file)) {
      read.poses.push_back({"", pose.time_s, pose.T_world_camera});
    }
  }
  if (read.poses.empty()) throw Error(file.string(), "holds no poses", "give one for each image");
  return read;
}

CameraPoses read_poses_of_camera(const std::filesystem::path& file_or_folder) {
  CameraPoses read = read_camera_poses(file_or_folder);
  if (read.of_body) {
    throw Error(file_or_folder.string(), "holds poses of the body, not of the camera",
                "give those of the camera");
  }
  return read;
}

std::vector<Pose> poses_of_images(const CameraPoses& poses,
                                  const std::vector<std::filesystem::path>& images,
                                  const std::string& place,
                                  double gap_s) {
  if (const auto found = by_time(poses, images, place, gap_s)) return *found;
  std::vector<Pose> found;
  const bool named = !poses.poses.empty() && !poses.poses[0].image.empty();
  if (!named) {
    if (poses.poses.size() != images.size()) {
      throw Error(place,
                  fmt::format("has {} poses for {} images", poses.poses.size(), images.size()),
                  "give one for each, in the order of their numbers");
    }
    for (const CameraPose& pose : poses.poses) found.push_back(pose.T_world_camera);
    return found;
  }
  std::vector<std::string> names;
  for (const CameraPose& pose : poses.poses) names.push_back(pose.image);
  for (const std::size_t pose : pose_names_of_images(names, images, place)) {
    found.push_back(poses.poses[pose].T_world_camera);
  }
  return found;
}

}  // namespace vernier::localise::internal
