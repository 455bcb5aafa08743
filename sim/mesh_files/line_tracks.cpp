// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Lines triangulated from images, as LIMAP writes them (Liu, Yu, Pautrat, Pollefeys, Larsson, "3D
// line mapping revisited", CVPR 2023): one file of all tracks, or a folder of one file each.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/base/text_lines.h"
#include "calib/error.h"
#include "sim/import/mesh.h"
#include "sim/mesh_files/mesh_file.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

constexpr std::string_view blanks = " \t\r";

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words = split_fields(line, blanks);
  std::erase(words, std::string_view());
  return words;
}

/// The lines of a file, of which each must be there.
class Rows {
 public:
  explicit Rows(const std::filesystem::path& file) : lines_(file) {}

  bool next() {
    std::string_view line;
    if (!lines_.next(line)) return false;
    words_ = words_of(line);
    return true;
  }
  void need(std::string_view what) {
    if (!next()) throw Error(lines_.place(), "ends before " + std::string(what), "write it again");
  }
  void need(std::size_t count, std::string_view what) {
    need(what);
    if (words_.size() == count) return;
    throw Error(lines_.place(),
                "has " + std::to_string(words_.size()) + " numbers for " + std::string(what),
                "give " + std::to_string(count));
  }
  double real(std::size_t i) const { return parse_real(words_.at(i), place(), "coordinate"); }
  int whole(std::size_t i, std::string_view what) const {
    return parse_whole(words_.at(i), place(), what);
  }
  Eigen::Vector3d point(std::size_t i) const { return {real(i), real(i + 1), real(i + 2)}; }
  const std::vector<std::string_view>& words() const { return words_; }
  std::string place() const { return lines_.place(); }

 private:
  TextLines lines_;
  std::vector<std::string_view> words_;
};

void add(Mesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b, const std::string& place) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back(a);
  mesh.vertices.push_back(b);
  mesh.lines.push_back({first, first + 1});
  if (mesh.lines.size() > most_triangles) {
    throw Error(place, "is one of more than " + std::to_string(most_triangles), "split the file");
  }
}

/// A number that counts something.
int count(const Rows& rows, std::size_t i, std::string_view what) {
  const int number = rows.whole(i, what);
  if (number >= 0) return number;
  throw Error(rows.place(), "has a negative " + std::string(what), "write the file again");
}

/// What a track says of itself.
struct TrackCounts {
  int lines = 0, images = 0;
};

/// Checks the words from `from` on, one for each line of a track, and how many are different.
void check_list(const Rows& rows,
                std::size_t from,
                const TrackCounts& counts,
                std::string_view what,
                std::optional<int> different = {}) {
  std::set<int> found;
  for (std::size_t i = from; i < rows.words().size(); ++i) found.insert(count(rows, i, what));
  const std::size_t words = rows.words().size() - std::min(from, rows.words().size());
  if (words != static_cast<std::size_t>(counts.lines)) {
    throw Error(rows.place(),
                "names " + std::to_string(words) + " of the " + std::string(what) + "s of " +
                    std::to_string(counts.lines) + " lines",
                "write the file again");
  }
  if (different && found.size() != static_cast<std::size_t>(*different)) {
    throw Error(
        rows.place(),
        "names " + std::to_string(found.size()) + " images, not " + std::to_string(*different),
        "write the file again");
  }
}

/// All tracks in one file: their number; of each "number, lines, images", the two ends, and the
/// numbers of the images and of the lines in them.
void read_all_tracks(const std::filesystem::path& file, int least_images, Mesh& mesh) {
  Rows rows(file);
  rows.need(1, "the number of tracks");
  const int tracks = count(rows, 0, "number of tracks");
  for (int i = 0; i < tracks; ++i) {
    const std::string what = "track " + std::to_string(i);
    rows.need(3, what);
    const TrackCounts counts{count(rows, 1, "number of lines"), count(rows, 2, "number of images")};
    rows.need(3, "the first end of " + what);
    const Eigen::Vector3d a = rows.point(0);
    rows.need(3, "the second end of " + what);
    const Eigen::Vector3d b = rows.point(0);
    rows.need("the images of " + what);
    check_list(rows, 0, counts, "image", counts.images);
    rows.need("the lines of " + what);
    check_list(rows, 0, counts, "line");
    if (counts.images >= least_images) {
      add(mesh, a, b, rows.place());
    } else {
      ++mesh.parts_left_out;
    }
  }
  while (rows.next()) {
    if (rows.words().empty()) continue;
    throw Error(rows.place(), "comes after the last of " + std::to_string(tracks) + " tracks",
                "correct the number in the first line");
  }
}

/// One track: both ends; "lines, images"; "image_id_list" and the images; what follows is not used.
void read_track(const std::filesystem::path& file, int least_images, Mesh& mesh) {
  Rows rows(file);
  rows.need(6, "the ends of the line");
  const Eigen::Vector3d a = rows.point(0), b = rows.point(3);
  rows.need(2, "the counts");
  const TrackCounts counts{count(rows, 0, "number of lines"), count(rows, 1, "number of images")};
  rows.need("image_id_list");
  if (rows.words().empty() || rows.words()[0] != "image_id_list") {
    throw Error(rows.place(), "is not image_id_list", "give tracks as LIMAP writes them");
  }
  check_list(rows, 1, counts, "image", counts.images);
  if (counts.images >= least_images) {
    add(mesh, a, b, rows.place());
  } else {
    ++mesh.parts_left_out;
  }
}

/// The files track_N.txt of a folder by N, each once.
std::vector<std::filesystem::path> track_files(const std::filesystem::path& folder) {
  std::vector<std::pair<int, std::filesystem::path>> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    constexpr std::string_view begin = "track_", end = ".txt";
    if (name.size() <= begin.size() + end.size() || !name.starts_with(begin) ||
        !name.ends_with(end)) {
      continue;
    }
    const std::string number = name.substr(begin.size(), name.size() - begin.size() - end.size());
    files.emplace_back(parse_whole(number, entry.path().string(), "track"), entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<std::filesystem::path> paths;
  for (auto& [number, path] : files) paths.push_back(std::move(path));
  return paths;
}

}  // namespace

bool holds_line_tracks(const std::filesystem::path& file) {
  TextLines lines(file);
  std::string_view line;
  if (!lines.next(line)) return false;
  const std::vector<std::string_view> words = words_of(line);
  return words.size() == 1 && words[0].find_first_not_of("0123456789") == std::string_view::npos;
}

Mesh read_line_tracks(const std::filesystem::path& path, int least_images) {
  Mesh mesh;
  mesh.format = "line tracks";
  if (!std::filesystem::is_directory(path)) {
    read_all_tracks(path, least_images, mesh);
    return mesh;
  }
  const std::vector<std::filesystem::path> files = track_files(path);
  if (files.empty()) {
    throw Error(path.string(), "holds no track_N.txt", "give a folder of line tracks, or a file");
  }
  for (const std::filesystem::path& file : files) read_track(file, least_images, mesh);
  return mesh;
}

}  // namespace vernier::sim::internal
