// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/observations_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <set>
#include <tuple>

#include "calib/atomic_file.h"
#include "calib/error.h"

namespace vernier {
namespace {

/// Lines of a text file with the number of each, for messages.
class Lines {
 public:
  explicit Lines(const std::filesystem::path& file) : file_(file), text_(read_whole(file)) {}

  bool next(std::string_view& line) {
    if (begin_ >= text_.size()) return false;
    const std::size_t end = std::min(text_.find('\n', begin_), text_.size());
    line = std::string_view(text_).substr(begin_, end - begin_);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    begin_ = end + 1;
    ++number_;
    return true;
  }

  std::string place() const { return file_.string() + ":" + std::to_string(number_); }

 private:
  std::filesystem::path file_;
  std::string text_;
  std::size_t begin_ = 0;
  int number_ = 0;
};

std::vector<std::string_view> split(std::string_view line, std::string_view separators) {
  std::vector<std::string_view> fields;
  std::size_t begin = 0;
  const bool blanks = separators.find(' ') != std::string_view::npos;
  while (begin <= line.size()) {
    const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
    if (!blanks || end > begin) fields.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return fields;
}

template <class Number>
Number parse_number(std::string_view field, const std::string& place, std::string_view what) {
  while (!field.empty() && field.front() == ' ') field.remove_prefix(1);
  while (!field.empty() && field.back() == ' ') field.remove_suffix(1);
  Number value{};
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size()) {
    throw Error(place, fmt::format("{} is \"{}\", not a number", what, field),
                "correct or remove the line");
  }
  return value;
}

/// One size stands for every camera.
void share_size(BoardObservations& observations, std::size_t cameras) {
  if (observations.size_px.size() == 1) {
    observations.size_px.resize(cameras, Eigen::Vector2i(observations.size_px[0]));
  }
}

constexpr int camera_limit = 1024;  // a wrong column read as the camera must not reserve memory
constexpr std::string_view observation_header = "frame,camera,row,col,X,Y,Z,qx,qy";

struct CornerRow {
  int frame, camera, row, col;
  Eigen::Vector3d target_m;
  Eigen::Vector2d pixel_px;
};

CornerRow parse_row(std::string_view line, const std::string& place) {
  const auto fields = split(line, ",");
  if (fields.size() < 9) {
    throw Error(place, fmt::format("{} columns where at least 9 are needed", fields.size()),
                fmt::format("the columns are {}", observation_header));
  }
  CornerRow r{};
  r.frame = parse_number<int>(fields[0], place, "frame");
  r.camera = parse_number<int>(fields[1], place, "camera");
  r.row = parse_number<int>(fields[2], place, "row");
  r.col = parse_number<int>(fields[3], place, "col");
  for (int i = 0; i < 3; ++i) r.target_m[i] = parse_number<double>(fields[4 + i], place, "X, Y, Z");
  for (int i = 0; i < 2; ++i) r.pixel_px[i] = parse_number<double>(fields[7 + i], place, "qx, qy");
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

/// What a file of observations has said so far.
class ObservationRows {
 public:
  void add(const CornerRow& row, const std::string& place) {
    const int id = id_of(row, place);
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

  BoardObservations take(const std::vector<Eigen::Vector2i>& size_px) {
    BoardObservations observations{size_px, std::move(target_m_), {}};
    for (auto& [key, view] : views_) observations.views.push_back(std::move(view));
    share_size(observations, cameras_);
    return observations;
  }

 private:
  int id_of(const CornerRow& row, const std::string& place) {
    const auto [id, is_new] =
        ids_.try_emplace({row.row, row.col}, static_cast<int>(target_m_.size()));
    if (is_new) {
      target_m_.push_back(row.target_m);
    } else if (target_m_[id->second] != row.target_m) {
      throw Error(place,
                  fmt::format("corner (row {}, col {}) has another place on the target than before",
                              row.row, row.col),
                  "one target a file");
    }
    return id->second;
  }

  std::vector<Eigen::Vector3d> target_m_;
  std::map<std::pair<int, int>, int> ids_;  // by row and column
  std::map<std::pair<int, int>, BoardView> views_;
  std::set<std::tuple<int, int, int>> seen_;  // frame, camera, corner
  std::size_t cameras_ = 0;
};

/// The images' cameras in order of first appearance, which is how a corners file numbers them.
class CameraOrder {
 public:
  int index(const std::string& camera) {
    const auto at = std::find(cameras_.begin(), cameras_.end(), camera);
    const auto index = at - cameras_.begin();
    if (at == cameras_.end()) cameras_.push_back(camera);
    return static_cast<int>(index);
  }
  std::size_t size() const { return cameras_.size(); }

 private:
  std::vector<std::string> cameras_;
};

/// Throws Error for an image whose name read_corners would not take for the same image.
void check_image_name(const BoardView& view, CameraOrder& cameras) {
  if (view.image.empty()) {
    throw Error(fmt::format("frame {}, camera {}", view.frame, view.camera),
                "its image has no name", "corners files need one");
  }
  if (view.image.find_first_of(" \t\r\n") != std::string::npos || view.image.front() == '#') {
    throw Error(view.image, "a corners file cannot hold a name with blanks or a leading #",
                "rename the image or its folder");
  }
  const int camera = cameras.index(parse_image_name(view.image).camera);
  if (camera != view.camera) {
    throw Error(
        view.image,
        fmt::format("by its name it would be read as camera {}, not {}", camera, view.camera),
        "name one camera's images alike but for their last number, and each camera's "
        "differently, like left01.png, right01.png");
  }
}

void check_counts(const std::map<std::string, int>& corners_of,
                  const BoardTarget& target,
                  const std::filesystem::path& file) {
  const auto corners = corner_grid(target).prod();
  for (const auto& [image, read] : corners_of) {
    // An image without a board has one line of dashes.
    if (read != corners && read != 1) {
      throw Error(
          file.string(),
          fmt::format("{} has {} corners, the {} has {}", image, read, name_of(target), corners),
          "check the board's size (of a chessboard, inner corners)");
    }
  }
}

/// The fourth column, 0 where there is none; below 0, as "-", it says that there is no corner.
int level_of(const std::vector<std::string_view>& fields, const std::string& place) {
  if (fields.size() < 4) return 0;
  return fields[3] == "-" ? -1 : parse_number<int>(fields[3], place, "level");
}

}  // namespace

BoardObservations read_observations(const std::filesystem::path& file,
                                    const std::vector<Eigen::Vector2i>& size_px) {
  Lines lines(file);
  std::string_view line;
  if (!lines.next(line) || line.substr(0, observation_header.size()) != observation_header) {
    throw Error(file.string() + ":1", "the first line is not the header of an observations file",
                fmt::format("it must begin with {}", observation_header));
  }
  ObservationRows rows;
  while (lines.next(line)) {
    if (!line.empty()) rows.add(parse_row(line, lines.place()), lines.place());
  }
  BoardObservations observations = rows.take(size_px);
  if (observations.views.empty()) {
    throw Error(file.string(), "no corner in it", "give an observations file with data");
  }
  check_and_sort(observations);
  return observations;
}

void write_observations(const BoardObservations& observations, const std::filesystem::path& file) {
  // A target without a grid of its own gets one row.
  const auto& target = observations.target_m;
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
  const bool grid = xs.size() * ys.size() == target.size();
  std::string text(observation_header);
  text += '\n';
  for (const BoardView& view : observations.views) {
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      const Eigen::Vector3d& p = target[view.ids[i]];
      const long row = grid ? index(ys, p.y()) : 0, col = grid ? index(xs, p.x()) : view.ids[i];
      text += fmt::format("{},{},{},{},{},{},{},{},{}\n", view.frame, view.camera, row, col, p.x(),
                          p.y(), p.z(), view.pixels_px[i].x(), view.pixels_px[i].y());
    }
  }
  write_atomically(file, text);
}

ImageName parse_image_name(const std::filesystem::path& image) {
  const std::string stem = image.stem().string();
  const std::size_t last = stem.find_last_of("0123456789");
  if (last == std::string::npos) {
    throw Error(image.string(), "no number in its name says which frame it is",
                "name images like left01.png, right01.png");
  }
  std::size_t first = last;
  while (first > 0 && std::isdigit(static_cast<unsigned char>(stem[first - 1]))) --first;
  int frame = 0;
  const auto parsed = std::from_chars(stem.data() + first, stem.data() + last + 1, frame);
  if (parsed.ec != std::errc()) {
    throw Error(image.string(), "its frame number is too large", "use numbers below 2147483648");
  }
  return {(image.parent_path() / (stem.substr(0, first) + "#" + stem.substr(last + 1))).string(),
          frame};
}

BoardObservations read_corners(const std::filesystem::path& file,
                               const BoardTarget& target,
                               const std::vector<Eigen::Vector2i>& size_px) {
  BoardObservations observations;
  observations.size_px = size_px;
  observations.target_m = target_points(target);
  const auto corners = corner_grid(target).prod();
  CameraOrder cameras;
  std::map<std::string, int> count;  // corners read of each image, found or not
  Lines lines(file);
  std::string_view line;
  while (lines.next(line)) {
    if (line.empty() || line.front() == '#') continue;
    const auto fields = split(line, " \t");
    if (fields.size() < 3) {
      throw Error(lines.place(), "fewer than three columns", "the columns are filename x y level");
    }
    const std::string image(fields[0]);
    const auto [counted, is_new] = count.try_emplace(image, 0);
    if (is_new) {
      const ImageName name = parse_image_name(image);
      // Images without a board count too, or a first one would hand its camera's place to another.
      observations.views.push_back({name.frame, cameras.index(name.camera), image, {}, {}});
    } else if (observations.views.back().image != image) {
      throw Error(lines.place(), image + " appears a second time",
                  "keep an image's lines together");
    }
    const int id = counted->second++;
    if (id >= corners) {
      throw Error(lines.place(), fmt::format("{} has more than {} corners", image, corners),
                  fmt::format("the board is said to be a {}", name_of(target)));
    }
    if (fields[1] == "-") continue;
    if (level_of(fields, lines.place()) < 0) continue;
    BoardView& view = observations.views.back();
    view.ids.push_back(id);
    view.pixels_px.emplace_back(parse_number<double>(fields[1], lines.place(), "x"),
                                parse_number<double>(fields[2], lines.place(), "y"));
  }
  check_counts(count, target, file);
  std::erase_if(observations.views, [](const BoardView& view) { return view.ids.size() < 4; });
  if (observations.views.empty()) {
    throw Error(file.string(), "no board in it", "give a corners file with data");
  }
  share_size(observations, cameras.size());
  check_and_sort(observations);
  return observations;
}

int count_coarse_corners(const std::filesystem::path& file) {
  Lines lines(file);
  std::string_view line;
  int count = 0;
  while (lines.next(line)) {
    if (line.empty() || line.front() == '#') continue;
    const auto fields = split(line, " \t");
    count += fields.size() > 3 && fields[1] != "-" && level_of(fields, lines.place()) > 0;
  }
  return count;
}

void write_corners(const BoardObservations& observations,
                   const BoardTarget& target,
                   const std::filesystem::path& file) {
  std::string text = "# filename x y level\n";
  std::vector<const BoardView*> views;
  for (const BoardView& view : observations.views) views.push_back(&view);
  std::stable_sort(views.begin(), views.end(), [](const BoardView* a, const BoardView* b) {
    return std::pair(a->camera, a->frame) < std::pair(b->camera, b->frame);
  });
  CameraOrder cameras;
  for (const BoardView* each : views) {
    const BoardView& view = *each;
    check_image_name(view, cameras);
    if (view.ids.empty()) {
      text += fmt::format("{} - - -\n", view.image);
      continue;
    }
    std::vector<const Eigen::Vector2d*> pixel(corner_grid(target).prod(), nullptr);
    for (std::size_t i = 0; i < view.ids.size(); ++i) pixel[view.ids[i]] = &view.pixels_px[i];
    for (const Eigen::Vector2d* p : pixel) {
      text += p ? fmt::format("{} {} {} 0\n", view.image, p->x(), p->y())
                : fmt::format("{} - - -\n", view.image);
    }
  }
  write_atomically(file, text);
}

}  // namespace vernier
