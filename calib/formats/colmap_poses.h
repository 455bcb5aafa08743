// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/pose.h"

/// Internal to calib/: COLMAP's text files and the camera poses in them. Not installed.
namespace vernier::internal::colmap {

/// The words of a line, with its location for messages. All members throw Error.
class Line {
 public:
  Line(const std::string& text, std::string place);

  const std::string& word(std::size_t index) const;
  double number(std::size_t index) const;  ///< finite
  int whole(std::size_t index) const;      ///< 0 to 1e9
  void check_count(std::size_t count) const;
  std::size_t size() const { return words_.size(); }
  const std::string& place() const { return place_; }

 private:
  std::vector<std::string> words_;
  std::string place_;
};

/// All lines except comments and blank ones; with `skip_every_second`, without the line after each
/// (images.txt: the points of the image, possibly none).
std::vector<Line> read_lines(const std::filesystem::path& file, bool skip_every_second = false);

/// The pose that begins at word `at`: QW QX QY QZ TX TY TZ, the translation in units of unit_m. The
/// quaternion must have length 1 to 1e-6.
Pose pose(const Line& line, std::size_t at, double unit_m);

struct PlacedId {
  int id = 0;
  std::string name;  ///< empty if not given
  Pose T_camera_reference;
};

/// Poses of the cameras of the file `cameras`, whose lines are `lines` by ascending CAMERA_ID, from
/// the files next to it; a single camera needs none. An entry of rig_config.json has no CAMERA_ID:
/// it is the camera with its model and parameters, else the one with images under its prefix, else
/// the one at its index, which is recorded in `notes`.
std::vector<PlacedId> read_poses(const std::filesystem::path& cameras,
                                 const std::vector<Line>& lines,
                                 double unit_m,
                                 std::vector<std::string>& notes);

}  // namespace vernier::internal::colmap
