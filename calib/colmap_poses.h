// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/pose.h"

/// Internal to calib/: COLMAP's text files and where they say the cameras are. Not installed.
namespace vernier::colmap {

/// The words of a line, with its place for complaints. All members throw Error.
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

/// All lines but comments and blank ones; with `skip_every_second`, without the line after each
/// (images.txt: the points of the image, perhaps none).
std::vector<Line> read_lines(const std::filesystem::path& file, bool skip_every_second = false);

struct PlacedId {
  int id = 0;
  std::string name;  ///< empty where unsaid
  Pose T_camera_reference;
};

/// Poses of the cameras `ids` (ascending), which are those of the file `cameras`, out of what lies
/// beside it; one camera needs none.
std::vector<PlacedId> read_poses(const std::filesystem::path& cameras,
                                 const std::vector<int>& ids,
                                 double unit_m);

}  // namespace vernier::colmap
