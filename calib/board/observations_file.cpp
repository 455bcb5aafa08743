// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/observations_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "calib/base/atomic_file.h"
#include "calib/base/text_lines.h"
#include "calib/board/corner_lines.h"
#include "calib/board_observations.h"
#include "calib/error.h"

namespace vernier {

using namespace internal;

namespace {

using corner_lines::check_pixel;

constexpr int camera_limit = 1024;  // a wrong column read as the camera must not reserve memory
constexpr std::string_view observation_header = "frame,camera,row,col,X,Y,Z,qx,qy";

struct CornerRow {
  int frame, camera, row, col;
  Eigen::Vector3d target_m;
  Eigen::Vector2d pixel_px;
};

CornerRow parse_row(std::string_view line, const std::string& place) {
  const auto fields = split_fields(line, ",");
  if (fields.size() < 9) {
    throw Error(place, fmt::format("{} columns, at least 9 are needed", fields.size()),
                fmt::format("the columns are {}", observation_header));
  }
  CornerRow r{};
  r.frame = parse_whole(fields[0], place, "frame");
  r.camera = parse_whole(fields[1], place, "camera");
  r.row = parse_whole(fields[2], place, "row");
  r.col = parse_whole(fields[3], place, "col");
  for (int i = 0; i < 3; ++i) r.target_m[i] = parse_real(fields[4 + i], place, "X, Y, Z");
  for (int i = 0; i < 2; ++i) r.pixel_px[i] = parse_real(fields[7 + i], place, "qx, qy");
  if (!r.target_m.allFinite() || !r.pixel_px.allFinite()) {
    throw Error(place, "a coordinate is not finite", "correct or remove the line");
  }
  if (r.frame < 0) {
    throw Error(place, fmt::format("frame is {}, below 0", r.frame), "number frames from 0");
  }
  if (r.camera < 0 || r.camera >= camera_limit) {
    throw Error(place, fmt::format("camera is {}, not within 0 to {}", r.camera, camera_limit - 1),
                "number cameras from 0");
  }
  return r;
}

/// Collects the lines of a file of observations.
class ObservationRows {
 public:
  explicit ObservationRows(const std::vector<Eigen::Vector2i>& size_px) : size_px_(size_px) {}

  void add(const CornerRow& row, const std::string& place) {
    const int id = id_of(row, place);
    check_pixel(row.pixel_px, row.camera, size_px_, place,
                fmt::format("frame {}, camera {}, corner (row {}, col {})", row.frame, row.camera,
                            row.row, row.col));
    if (!seen_.insert({row.frame, row.camera, id}).second) {
      throw Error(place,
                  fmt::format("frame {}, camera {}, corner (row {}, col {}) appears a second time",
                              row.frame, row.camera, row.row, row.col),
                  "remove one of the lines");
    }
    BoardView& view = views_[{row.frame, row.camera}];
    view.frame = row.frame;
    view.camera = row.camera;
    view.ids.push_back(id);
    view.pixels_px.push_back(row.pixel_px);
    cameras_ = std::max<std::size_t>(cameras_, row.camera + 1);
  }

  BoardObservations take(const std::filesystem::path& file) {
    BoardObservations observations{size_px_, std::move(target_m_), {}};
    for (auto& [key, view] : views_) observations.views.push_back(std::move(view));
    if (observations.views.empty()) {
      throw Error(file.string(), "it contains no corner", "give an observations file with data");
    }
    return corner_lines::finished(std::move(observations), cameras_, file);
  }

 private:
  int id_of(const CornerRow& row, const std::string& place) {
    const auto [id, is_new] =
        ids_.try_emplace({row.row, row.col}, static_cast<int>(target_m_.size()));
    if (is_new) {
      target_m_.push_back(row.target_m);
    } else if (target_m_[id->second] != row.target_m) {
      throw Error(
          place,
          fmt::format("corner (row {}, col {}) has another position on the target than before",
                      row.row, row.col),
          "use one target per file");
    }
    return id->second;
  }

  const std::vector<Eigen::Vector2i>& size_px_;
  std::vector<Eigen::Vector3d> target_m_;
  std::map<std::pair<int, int>, int> ids_;  // by row and column
  std::map<std::pair<int, int>, BoardView> views_;
  std::set<std::tuple<int, int, int>> seen_;  // frame, camera, corner
  std::size_t cameras_ = 0;
};

}  // namespace

BoardObservations read_observations(const std::filesystem::path& file,
                                    const std::vector<Eigen::Vector2i>& size_px) {
  TextLines lines(file);
  std::string_view line;
  if (!lines.next(line) || line.substr(0, observation_header.size()) != observation_header) {
    throw Error(file.string() + ":1", "the first line is not the header of an observations file",
                fmt::format("it must begin with {}", observation_header));
  }
  ObservationRows rows(size_px);
  while (lines.next(line)) {
    if (!line.empty()) rows.add(parse_row(line, lines.place()), lines.place());
  }
  return rows.take(file);
}

namespace {

/// Row and column of every point on the target; a target without a grid of its own is one row.
std::vector<std::pair<long, long>> rows_and_columns(const std::vector<Eigen::Vector3d>& target) {
  std::vector<double> xs, ys;
  for (const auto& point : target) {
    xs.push_back(point.x());
    ys.push_back(point.y());
  }
  for (auto* values : {&xs, &ys}) {
    std::sort(values->begin(), values->end());
    values->erase(std::unique(values->begin(), values->end()), values->end());
  }
  const auto index = [](const std::vector<double>& values, double value) {
    return std::lower_bound(values.begin(), values.end(), value) - values.begin();
  };
  std::vector<std::pair<long, long>> places, in_one_row;
  for (const auto& point : target) {
    places.emplace_back(index(ys, point.y()), index(xs, point.x()));
    in_one_row.emplace_back(0, static_cast<long>(in_one_row.size()));
  }
  // Two points that differ in height only would be one corner.
  const bool is_grid = xs.size() * ys.size() == target.size() &&
                       std::set(places.begin(), places.end()).size() == target.size();
  return is_grid ? places : in_one_row;
}

}  // namespace

void write_observations(const BoardObservations& observations, const std::filesystem::path& file) {
  const auto& target = observations.target_m;
  const std::vector<std::pair<long, long>> places = rows_and_columns(target);
  std::string text(observation_header);
  text += '\n';
  for (const BoardView& view : observations.views) {
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      const Eigen::Vector3d& p = target[view.ids[i]];
      const auto [row, col] = places[static_cast<std::size_t>(view.ids[i])];
      text += fmt::format("{},{},{},{},{},{},{},{},{}\n", view.frame, view.camera, row, col, p.x(),
                          p.y(), p.z(), view.pixels_px[i].x(), view.pixels_px[i].y());
    }
  }
  write_atomically(file, text);
}

}  // namespace vernier
