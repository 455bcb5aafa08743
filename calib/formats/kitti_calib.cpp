// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/formats/kitti_calib.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/joined_numbers.h"
#include "calib/base/shown_text.h"
#include "calib/base/text_lines.h"
#include "calib/camera.h"
#include "calib/camera/opencv_intrinsics.h"
#include "calib/camera/rig_limits.h"
#include "calib/error.h"
#include "calib/formats/imported_rig.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal {
namespace {

constexpr std::size_t matrix_numbers = 12, camera_matrix_numbers = 9;
constexpr const char* layouts = "give matrices of 3 x 4, P0: … or P_rect_00: …, or one of 3 x 3";

using ProjectionMatrix = Eigen::Matrix<double, 3, 4>;

/// A projection matrix, where it stands, and what it is called.
struct Projection {
  std::string name, place;
  ProjectionMatrix P;
};

struct CalibText {
  std::vector<Projection> projections;           ///< in the file's order
  std::map<std::string, Eigen::Vector2i> sizes;  ///< by the number of a camera: "00"
  std::vector<std::string> ignored;
};

ProjectionMatrix matrix_of(const double* v) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(v);
}

/// The digits of a name such as P2 or P_rect_02; empty for other names.
std::string_view digits_after(std::string_view name, std::string_view prefix) {
  if (!name.starts_with(prefix)) return {};
  const std::string_view digits = name.substr(prefix.size());
  return !digits.empty() && std::all_of(digits.begin(), digits.end(), is_digit)
             ? digits
             : std::string_view();
}

Eigen::Vector2i size_of(const std::vector<double>& v, const std::string& place) {
  const auto whole = [](double s) {
    return s >= 1 && s <= most_side_px && s == static_cast<double>(static_cast<int>(s));
  };
  if (v.size() != 2 || !whole(v[0]) || !whole(v[1])) {
    throw Error(place, "is not a size, two whole numbers above 0", "correct it");
  }
  return {static_cast<int>(v[0]), static_cast<int>(v[1])};
}

void read_entry(std::string_view name,
                std::string_view values,
                const std::string& line_place,
                CalibText& read) {
  const std::string place = line_place + ": " + shortened(name);
  if (const std::string_view number = digits_after(name, "S_rect_"); !number.empty()) {
    read.sizes[std::string(number)] = size_of(joined_numbers(values, place), place);
  } else if (!digits_after(name, "P_rect_").empty() || !digits_after(name, "P").empty()) {
    const std::vector<double> v = joined_numbers(values, place);
    if (v.size() != matrix_numbers) {
      throw Error(place, fmt::format("has {} numbers, not 12", v.size()), "give a 3 x 4 matrix");
    }
    for (const Projection& other : read.projections) {
      if (other.name == name) throw Error(place, "stands a second time", "keep one of them");
    }
    read.projections.push_back({std::string(name), place, matrix_of(v.data())});
  } else {
    read.ignored.emplace_back(shortened(name));
  }
}

/// Matrices without names: 3 x 4 ones, or one of 3 x 3.
void take_unnamed(const std::vector<double>& v, const std::string& place, CalibText& read) {
  if (v.size() == camera_matrix_numbers) {
    ProjectionMatrix P = ProjectionMatrix::Zero();
    P.leftCols<3>() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(v.data());
    read.projections.push_back({"", place, P});
    return;
  }
  if (v.empty() || v.size() % matrix_numbers != 0) {
    throw Error(place, fmt::format("holds {} numbers", v.size()), layouts);
  }
  for (std::size_t at = 0; at < v.size(); at += matrix_numbers) {
    const std::size_t i = at / matrix_numbers;
    const std::string name = v.size() > 2 * matrix_numbers ? fmt::format("P{}", i) : "";
    read.projections.push_back(
        {name, fmt::format("{}: matrix {}", place, i + 1), matrix_of(v.data() + at)});
  }
}

CalibText read_text(const std::string& text, const std::string& file) {
  CalibText read;
  std::vector<double> unnamed;
  std::istringstream lines(text);
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    const std::string place = fmt::format("{}:{}", file, number);
    const std::size_t colon = line.find(':');
    if (colon != std::string::npos) {
      const std::string_view all(line);
      read_entry(all.substr(first, colon - first), all.substr(colon + 1), place, read);
      continue;
    }
    const std::vector<double> v = joined_numbers(line, place);
    unnamed.insert(unnamed.end(), v.begin(), v.end());
    if (unnamed.size() > most_cameras * matrix_numbers) {
      throw Error(place, fmt::format("holds more than {} matrices", most_cameras), layouts);
    }
  }
  const bool named = !read.projections.empty() || !read.ignored.empty();
  if (named && !unnamed.empty()) {
    throw Error(file, "holds numbers with and without names", layouts);
  }
  if (!named) take_unnamed(unnamed, file, read);
  if (read.projections.empty()) throw Error(file, "holds no projection matrix", layouts);
  return read;
}

/// The size of a matrix's images: by the number of its camera, or as given.
Eigen::Vector2i size_of(const Projection& projection,
                        const CalibText& read,
                        const ImportOptions& options) {
  const std::string number(digits_after(projection.name, "P_rect_"));
  if (const auto stated = read.sizes.find(number); stated != read.sizes.end()) {
    return stated->second;
  }
  if (options.size_px) {
    const Eigen::Vector2i size_px = *options.size_px;
    const double x = projection.P(0, 2), y = projection.P(1, 2);
    if (!(x >= 0 && x < size_px[0] && y >= 0 && y < size_px[1])) {
      throw Error(projection.place,
                  fmt::format("its centre, ({:.0f}, {:.0f}), is outside images of {}x{}", x, y,
                              size_px[0], size_px[1]),
                  "use the calibration of these images");
    }
    return size_px;
  }
  throw Error(projection.place, "the file does not state the size of the images",
              "give it: convert FILE --size WxH -o rig.json");
}

PlacedCamera camera_of(const Projection& projection,
                       const CalibText& read,
                       const ImportOptions& options) {
  const Eigen::Matrix3d K = projection.P.leftCols<3>();
  PlacedCamera placed;
  placed.camera =
      camera_from_opencv(intrinsics_of_camera_matrix(K, projection.place),
                         size_of(projection, read, options), projection.place, options.model);
  placed.camera.name = projection.name;
  placed.T_camera_reference.t =
      translation(K.inverse() * projection.P.col(3), options.unit_m, projection.place);
  return placed;
}

}  // namespace

ImportedRig parse_kitti_calib(const std::string& text,
                              const std::string& place,
                              const ImportOptions& options) {
  const CalibText read = read_text(text, place);
  ImportedRig imported;
  std::vector<PlacedCamera> cameras;
  for (const Projection& projection : read.projections) {
    cameras.push_back(camera_of(projection, read, options));
  }
  if (!read.ignored.empty()) {
    imported.notes.push_back(fmt::format(
        "{}: {}{} ignored: only rectified images are described", place, read.ignored.front(),
        read.ignored.size() == 1 ? " is"
                                 : fmt::format(" and {} others are", read.ignored.size() - 1)));
  }
  imported.rig = rig_of(std::move(cameras));
  return imported;
}

ImportedRig read_kitti_calib(const std::filesystem::path& file, const ImportOptions& options) {
  return parse_kitti_calib(read_whole(file), file.string(), options);
}

bool looks_like_kitti_calib(const std::string& text) {
  std::istringstream lines(text);
  bool named = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("P_rect_") || line.starts_with("P0:")) return true;
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (named || first == std::string::npos || line[first] == '#') continue;
    named = line.find(':') != std::string::npos;
    if (named) continue;
    try {
      const std::size_t n = joined_numbers(line, "").size();
      return n == 3 || n == camera_matrix_numbers || n % matrix_numbers == 0;
    } catch (const Error&) {
      return false;
    }
  }
  return false;
}

}  // namespace vernier::internal
