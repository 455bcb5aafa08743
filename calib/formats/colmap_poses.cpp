// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/formats/colmap_poses.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include "calib/base/atomic_file.h"
#include "calib/base/json_reader.h"
#include "calib/base/shown_text.h"
#include "calib/base/text_lines.h"
#include "calib/error.h"
#include "calib/formats/imported_rig.h"
#include "calib/formats/rig_json.h"
#include "calib/pose.h"

namespace vernier::internal::colmap {
namespace {

using rig_json::Json;
using rig_json::Node;

Pose pose(const Eigen::Vector4d& wxyz, const Eigen::Vector3d& t_m, const std::string& place) {
  if (!(std::abs(wxyz.norm() - 1) <= 1e-2)) {
    throw Error(place, fmt::format("its quaternion has the length {}", wxyz.norm()),
                "it must be 1 to 1 %");
  }
  const Eigen::Quaterniond q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  return {q.normalized().toRotationMatrix(), t_m};
}

/// The cameras of cameras.txt and the unit of length.
struct Cameras {
  const std::vector<Line>& lines;  ///< by ascending CAMERA_ID
  double unit_m;

  std::size_t count() const { return lines.size(); }
  int id(std::size_t i) const { return lines[i].whole(0); }
};

void check_camera(int id, const std::vector<int>& ids, const std::string& place) {
  if (std::find(ids.begin(), ids.end(), id) == ids.end()) {
    throw Error(place, fmt::format("cameras.txt has no camera {}", id),
                "give the files of one rig");
  }
}

std::vector<PlacedId> from_rigs(const std::filesystem::path& file,
                                const Cameras& cameras,
                                std::vector<std::string>&) {
  const std::vector<Line> lines = read_lines(file);
  if (lines.size() != 1) {
    throw Error(file.string(), fmt::format("holds {} rigs", lines.size()), "keep one");
  }
  const Line& line = lines[0];
  std::vector<PlacedId> placed{{line.whole(3), "", Pose{}}};
  for (std::size_t at = 4; at < line.size();) {
    if (line.word(at) != "CAMERA") {
      throw Error(line.place(), "holds a sensor " + in_quotes(line.word(at)),
                  "keep the cameras only");
    }
    if (line.whole(at + 2) == 0) {
      throw Error(line.place(), fmt::format("camera {} has no pose", line.whole(at + 1)),
                  "solve for it in COLMAP first");
    }
    placed.push_back({line.whole(at + 1), "", pose(line, at + 3, cameras.unit_m)});
    at += 10;
  }
  return placed;
}

/// left of "rig1/left/".
std::string name_of_prefix(std::string prefix) {
  while (!prefix.empty() && prefix.back() == '/') prefix.pop_back();
  return prefix.substr(prefix.rfind('/') + 1);
}

PlacedId from_entry(const Node& camera, int id, double unit_m) {
  PlacedId placed{id, name_of_prefix(camera.at("image_prefix").text()), Pose{}};
  const bool reference = camera.has("ref_sensor") && camera.at("ref_sensor").json() == true;
  if (reference) return placed;
  const Node rotation = camera.at("cam_from_rig_rotation");
  const Eigen::VectorXd q = rotation.vector();
  if (q.size() != 4) throw Error(rotation.place(), "is not a quaternion of 4 numbers", "");
  const Node t = camera.at("cam_from_rig_translation");
  placed.T_camera_reference =
      pose(q, translation(t.vector3(), unit_m, t.place()), rotation.place());
  return placed;
}

/// Whether a camera has the model and the parameters of an entry, up to rounding.
bool has_parameters(const Line& camera, const Node& entry) {
  constexpr double rounding = 1e-9;
  if (!entry.has("camera_model_name") || !entry.has("camera_params")) return false;
  const Eigen::VectorXd values = entry.at("camera_params").vector();
  if (camera.word(1) != entry.at("camera_model_name").text()) return false;
  if (camera.size() != 4 + static_cast<std::size_t>(values.size())) return false;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const double there = camera.number(4 + static_cast<std::size_t>(i));
    if (!(std::abs(there - values[i]) <= rounding * (1 + std::abs(there)))) return false;
  }
  return true;
}

/// The cameras of the images under each prefix, from images.txt if it exists.
using CamerasOfPrefix = std::map<std::string, std::set<int>>;
CamerasOfPrefix cameras_of_prefixes(const std::filesystem::path& images, const Node& entries) {
  CamerasOfPrefix found;
  if (!std::filesystem::exists(images)) return found;
  for (const Line& line : read_lines(images, true)) {
    line.check_count(10);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const std::string prefix = entries.at(i).at("image_prefix").text();
      if (line.word(9).rfind(prefix, 0) == 0) found[prefix].insert(line.whole(8));
    }
  }
  return found;
}

/// The CAMERA_ID of each entry if all are identified and distinct; else empty.
std::vector<int> identified_cameras(const Node& entries,
                                    const Cameras& cameras,
                                    const CamerasOfPrefix& of_prefix) {
  std::vector<int> ids;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const Node entry = entries.at(i);
    std::set<int> candidates;
    for (std::size_t k = 0; k < cameras.count(); ++k) {
      if (has_parameters(cameras.lines[k], entry)) candidates.insert(cameras.id(k));
    }
    const auto under = of_prefix.find(entry.at("image_prefix").text());
    if (entry.has("camera_id")) {
      candidates = {entry.at("camera_id").integer()};
    } else if (candidates.size() != 1 && under != of_prefix.end()) {
      candidates = under->second;
    }
    if (candidates.size() != 1) return {};
    ids.push_back(*candidates.begin());
  }
  const std::set<int> different(ids.begin(), ids.end());
  return different.size() == ids.size() ? ids : std::vector<int>();
}

std::vector<PlacedId> from_rig_config(const std::filesystem::path& file,
                                      const Cameras& cameras,
                                      std::vector<std::string>& notes) {
  const Json json = parse_json(read_whole(file), file.string());
  const Node root(json, file.string() + ":");
  if (root.array().size() != 1) {
    throw Error(file.string(), fmt::format("holds {} rigs", root.size()), "keep one");
  }
  const Node entries = root.at(0).at("cameras");
  if (entries.array().size() != cameras.count()) {
    throw Error(entries.place(),
                fmt::format("holds {} cameras, cameras.txt {}", entries.size(), cameras.count()),
                "give the files of one rig");
  }
  std::vector<int> ids = identified_cameras(
      entries, cameras, cameras_of_prefixes(file.parent_path() / "images.txt", entries));
  if (ids.empty()) {
    for (std::size_t i = 0; i < cameras.count(); ++i) ids.push_back(cameras.id(i));
    if (cameras.count() > 1)
      notes.push_back(file.string() +
                      ": its cameras are matched by order with those of cameras.txt, since neither "
                      "parameters nor images.txt identify them");
  }
  std::vector<PlacedId> placed;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    placed.push_back(from_entry(entries.at(i), ids[i], cameras.unit_m));
  }
  return placed;
}

std::vector<PlacedId> from_images(const std::filesystem::path& file,
                                  const Cameras& cameras,
                                  std::vector<std::string>&) {
  std::vector<PlacedId> placed;
  for (const Line& line : read_lines(file, true)) {
    line.check_count(10);
    const std::string& image = line.word(9);
    const std::size_t slash = image.rfind('/');
    const std::string name = slash == std::string::npos
                                 ? std::filesystem::path(image).stem().string()
                                 : name_of_prefix(image.substr(0, slash));
    placed.push_back({line.whole(8), name, pose(line, 1, cameras.unit_m)});
  }
  if (placed.size() != cameras.count()) {
    if (cameras.count() == 1) return {{cameras.id(0), "", Pose{}}};
    throw Error(
        file.string(),
        fmt::format(
            "holds {} images of {} cameras, so it does not define the cameras' poses on the rig",
            placed.size(), cameras.count()),
        "keep one frame of the rig, or give rigs.txt or rig_config.json");
  }
  return placed;
}

std::vector<PlacedId> from_beside(const std::filesystem::path& file,
                                  const Cameras& cameras,
                                  std::vector<std::string>& notes) {
  const std::filesystem::path folder = file.parent_path();
  for (const auto& [name, reader] :
       {std::pair{"rigs.txt", &from_rigs}, std::pair{"rig_config.json", &from_rig_config},
        std::pair{"images.txt", &from_images}}) {
    if (std::filesystem::exists(folder / name)) return reader(folder / name, cameras, notes);
  }
  if (cameras.count() == 1) return {{cameras.id(0), "", Pose{}}};
  throw Error(
      file.string(),
      fmt::format("holds {} cameras, but no file next to it gives their poses", cameras.count()),
      "put rigs.txt, rig_config.json or images.txt in the same folder");
}

}  // namespace

Pose pose(const Line& line, std::size_t at, double unit_m) {
  Eigen::Matrix<double, 7, 1> v;
  for (std::size_t i = 0; i < 7; ++i) v[static_cast<Eigen::Index>(i)] = line.number(at + i);
  return pose(v.head<4>(), translation(v.tail<3>(), unit_m, line.place()), line.place());
}

Line::Line(const std::string& text, std::string place) : place_(std::move(place)) {
  constexpr std::size_t most_words = 1000;  // a rig of 32 cameras has 323
  std::istringstream in(text);
  for (std::string word; in >> word;) {
    if (words_.size() == most_words) {
      throw Error(place_, fmt::format("has more than {} words", most_words), "correct it");
    }
    words_.push_back(word);
  }
}

const std::string& Line::word(std::size_t index) const {
  if (index < words_.size()) return words_[index];
  throw Error(place_, fmt::format("has only {} words", words_.size()), "correct it");
}

double Line::number(std::size_t index) const {
  const std::string& text = word(index);
  if (const auto value = to_finite(text)) return *value;
  throw Error(place_, in_quotes(text) + " is not a finite number", "correct it");
}

int Line::whole(std::size_t index) const {
  const double value = number(index);
  if (value >= 0 && value <= 1e9 && value == std::round(value)) return static_cast<int>(value);
  throw Error(place_, fmt::format("{} is not a whole number", value), "correct it");
}

void Line::check_count(std::size_t count) const {
  if (words_.size() == count) return;
  throw Error(place_, fmt::format("has {} words, not {}", words_.size(), count), "correct it");
}

std::vector<Line> read_lines(const std::filesystem::path& file, bool skip_every_second) {
  std::istringstream in(read_whole(file));
  std::vector<Line> lines;
  int number = 0;
  for (std::string text; std::getline(in, text);) {
    ++number;
    const std::size_t first = text.find_first_not_of(" \t\r");
    if (first == std::string::npos || text[first] == '#') continue;
    lines.emplace_back(text, fmt::format("{}:{}", file.string(), number));
    if (skip_every_second && std::getline(in, text)) ++number;
  }
  return lines;
}

std::vector<PlacedId> read_poses(const std::filesystem::path& cameras,
                                 const std::vector<Line>& lines,
                                 double unit_m,
                                 std::vector<std::string>& notes) {
  std::vector<int> ids, found;
  for (const Line& line : lines) ids.push_back(line.whole(0));
  std::vector<PlacedId> placed = from_beside(cameras, {lines, unit_m}, notes);
  for (const PlacedId& p : placed) {
    check_camera(p.id, ids, cameras.string());
    found.push_back(p.id);
  }
  std::sort(found.begin(), found.end());
  if (found != ids) {
    throw Error(cameras.string(), "not every camera of it has one pose",
                "give the files of one rig");
  }
  return placed;
}

}  // namespace vernier::internal::colmap
