// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/text_lines.h"
#include "calib/board/corner_lines.h"
#include "calib/board/frame_numbering.h"
#include "calib/board_observations.h"
#include "calib/board_target.h"
#include "calib/error.h"
#include "calib/observations_file.h"

namespace vernier {

using namespace internal;

namespace {

using corner_lines::check_pixel;

/// Numbers the cameras of the images in order of first appearance, as a corners file does.
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

/// Throws Error if read_corners would assign the image's name to another view.
void check_image_view(const BoardView& view, CameraOrder& cameras) {
  if (view.image.empty()) {
    throw Error(fmt::format("frame {}, camera {}", view.frame, view.camera),
                "its image has no name", "corners files need one");
  }
  check_corners_image(view.image);
  const int camera = cameras.index(parse_image_name(view.image).camera);
  if (camera != view.camera) {
    throw Error(
        view.image,
        fmt::format("by its name it would be read as camera {}, not {}", camera, view.camera),
        "name one camera's images alike but for their last number, and each camera's "
        "differently, like left01.png, right01.png");
  }
}

/// The fourth column, 0 if absent; below 0 ("-") means that there is no corner.
int level_of(const std::vector<std::string_view>& fields, const std::string& place) {
  if (fields.size() < 4) return 0;
  return fields[3] == "-" ? -1 : parse_whole(fields[3], place, "level");
}

/// Collects the lines of a corners file.
class CornerReader {
 public:
  CornerReader(const BoardTarget& target, const std::vector<Eigen::Vector2i>& size_px)
      : target_(target), grid_(corner_grid(target)), size_px_(size_px) {}

  void add(const std::vector<std::string_view>& fields, const std::string& place) {
    if (fields.size() < 3) {
      throw Error(place, "fewer than three columns", "the columns are filename x y level");
    }
    const std::string image(fields[0]);
    BoardView& view = view_of(image, place);
    const int id = count_[image]++;
    if (id >= grid_.prod()) {
      throw Error(place, fmt::format("{} has more than {} corners", image, grid_.prod()),
                  fmt::format("the board was given as a {}", name_of(target_)));
    }
    if (fields[1] == "-" || level_of(fields, place) < 0) return;
    const Eigen::Vector2d pixel_px(parse_real(fields[1], place, "x"),
                                   parse_real(fields[2], place, "y"));
    check_pixel(pixel_px, view.camera, size_px_, place,
                fmt::format("{}, corner (row {}, col {})", image, id / grid_.x(), id % grid_.x()));
    view.ids.push_back(id);
    view.pixels_px.push_back(pixel_px);
  }

  BoardObservations take(const std::filesystem::path& file) {
    for (const auto& [image, read] : count_) {
      // An image without a board has a single line of dashes.
      if (read == grid_.prod() || read == 1) continue;
      throw Error(file.string(),
                  fmt::format("{} has {} corners, the {} has {}", image, read, name_of(target_),
                              grid_.prod()),
                  "check the board's size (of a chessboard, inner corners)");
    }
    number_frames(file);
    std::erase_if(views_, [](const BoardView& view) { return view.ids.size() < 4; });
    if (views_.empty()) {
      throw Error(file.string(), "it contains no board", "give a corners file with data");
    }
    return corner_lines::finished({size_px_, target_points(target_), std::move(views_)},
                                  cameras_.size(), file);
  }

 private:
  void number_frames(const std::filesystem::path& file) {
    const std::size_t frames = std::set<std::int64_t>(numbers_.begin(), numbers_.end()).size();
    if (cameras_.size() >= 5 && cameras_.size() >= 2 * frames) {  // no rig is calibrated like that
      throw Error(file.string(),
                  fmt::format("by their names the images are of {} cameras and {} frames: the last "
                              "number in a name is the frame, the rest is the camera",
                              cameras_.size(), frames),
                  "name images like cam0_frame01.png, cam1_frame01.png");
    }
    const FrameNumbering numbering(numbers_);
    for (std::size_t i = 0; i < views_.size(); ++i) views_[i].frame = numbering.frame(numbers_[i]);
  }

  BoardView& view_of(const std::string& image, const std::string& place) {
    if (count_.try_emplace(image, 0).second) {
      const ImageName name = parse_image_name(image);
      // Images without a board are counted too, to keep the numbering of the cameras.
      views_.push_back({0, cameras_.index(name.camera), image, {}, {}});
      numbers_.push_back(name.frame);
    } else if (views_.back().image != image) {
      throw Error(place, image + " appears a second time", "keep an image's lines together");
    }
    return views_.back();
  }

  const BoardTarget& target_;
  Eigen::Vector2i grid_;  // columns, rows
  const std::vector<Eigen::Vector2i>& size_px_;
  std::vector<BoardView> views_;
  std::vector<std::int64_t> numbers_;  // one per view, in its image's name
  CameraOrder cameras_;
  std::map<std::string, int> count_;  // corners read of each image, found or not
};

}  // namespace

BoardObservations read_corners(const std::filesystem::path& file,
                               const BoardTarget& target,
                               const std::vector<Eigen::Vector2i>& size_px) {
  check_target(target);
  CornerReader reader(target, size_px);
  TextLines lines(file);
  std::string_view line;
  while (lines.next(line)) {
    if (!line.empty() && line.front() != '#') reader.add(split_fields(line, " \t"), lines.place());
  }
  return reader.take(file);
}

int count_coarse_corners(const std::filesystem::path& file) {
  TextLines lines(file);
  std::string_view line;
  int count = 0;
  while (lines.next(line)) {
    if (line.empty() || line.front() == '#') continue;
    const auto fields = split_fields(line, " \t");
    count += fields.size() > 3 && fields[1] != "-" && level_of(fields, lines.place()) > 0;
  }
  return count;
}

void check_corners_image(const std::string& image) {
  if (image.find_first_of(" \t\r\n") == std::string::npos && !image.starts_with('#')) return;
  throw Error(image, "a corners file cannot hold a name with blanks or a leading #",
              "rename the image or its folder");
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
    check_image_view(view, cameras);
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
