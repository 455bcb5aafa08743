// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board_detection.h"

#include <glob.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <variant>

#include "calib/base/grey_image.h"
#include "calib/board/chessboard_finder.h"
#include "calib/board/frame_numbering.h"
#include "calib/board/marker_board.h"
#include "calib/board_observations.h"
#include "calib/board_target.h"
#include "calib/error.h"
#include "calib/observations_file.h"

namespace vernier {

using namespace internal;

namespace {

BoardView view_of(const BoardDetection& found) {
  BoardView view;
  view.frame = found.frame;
  view.camera = found.camera;
  view.image = found.image.string();  // with its folder, which may identify the camera
  view.ids = found.ids;
  view.pixels_px = found.corners_px;
  return view;
}

/// The frame numbers of the images. Throws Error if a camera shares no frame number with the
/// cameras before it, or has a number twice.
std::vector<std::int64_t> frame_numbers(
    const std::vector<std::vector<std::filesystem::path>>& images) {
  std::set<std::int64_t> before;
  for (std::size_t camera = 0; camera < images.size(); ++camera) {
    std::set<std::int64_t> frames;
    for (const auto& image : images[camera]) {
      const std::int64_t number = parse_image_name(image).frame;
      if (frames.insert(number).second) continue;
      throw Error(
          image.string(),
          "another image of this camera has the frame number " + std::to_string(number) + " too",
          "the last number in a name is the frame: name images like cam0_frame01.png");
    }
    const auto met = [&](std::int64_t frame) { return before.count(frame) > 0; };
    if (camera > 0 && std::none_of(frames.begin(), frames.end(), met)) {
      const auto& first = images.front().front();
      const auto& own = images[camera].front();
      throw Error(own.string(),
                  "its camera shares no frame number with the cameras before it (here " +
                      std::to_string(parse_image_name(own).frame) + ", but " +
                      std::to_string(parse_image_name(first).frame) + " in " + first.string() + ")",
                  "the last number in a name is the frame; give simultaneous images the same");
    }
    before.insert(frames.begin(), frames.end());
  }
  return {before.begin(), before.end()};
}

/// The board of an image. An image that cannot be read is recorded as refused, with the reason; the
/// first such Error is kept.
BoardDetection detect_or_refuse(const std::filesystem::path& image,
                                const BoardTarget& target,
                                std::optional<Error>& first_fault) {
  try {
    return detect_board(image, target);
  } catch (const Error& error) {
    if (!first_fault) first_fault = error;
    BoardDetection refused;
    refused.image = image;
    refused.reason = error.fault() + (error.remedy().empty() ? "" : "; " + error.remedy());
    return refused;
  }
}

void add_detection(const BoardDetection& found, ImageDetections& result) {
  if (found.size_px == Eigen::Vector2i::Zero()) {  // it could not be read
    result.refused.push_back(found);
    return;
  }
  auto& size = result.observations.size_px[found.camera];
  if (size == Eigen::Vector2i::Zero()) size = found.size_px;
  if (size != found.size_px) {
    throw Error(found.image.string(),
                "its size " + std::to_string(found.size_px[0]) + "x" +
                    std::to_string(found.size_px[1]) + " differs from the images before it (" +
                    std::to_string(size[0]) + "x" + std::to_string(size[1]) + ")",
                "give images of one size per camera");
  }
  if (found.ids.empty()) {
    result.refused.push_back(found);
    return;
  }
  result.observations.views.push_back(view_of(found));
  result.used.push_back(found);
}

/// Throws Error, naming them, if images show tags beyond the board's in its own arrangement.
void check_ids(const ImageDetections& found, const std::string& place, const std::string& name) {
  std::set<int> ids;
  std::size_t images = 0;
  for (const BoardDetection& image : found.used) {
    ids.insert(image.ids_beyond.begin(), image.ids_beyond.end());
    images += image.ids_beyond.empty() ? 0 : 1;
  }
  if (ids.empty()) return;
  std::string list;
  constexpr std::size_t shown = 12;
  std::size_t count = 0;
  for (const int id : ids) {
    if (count++ < shown) list += (list.empty() ? "" : ", ") + std::to_string(id);
  }
  if (ids.size() > shown) list += ", …";
  throw Error(place,
              "in " + std::to_string(images) + " of " +
                  std::to_string(found.refused.size() + found.used.size()) +
                  " images the board goes on with tags that the " + name + " has not: " + list,
              "count its rows and columns again");
}

void check_found(const ImageDetections& found, const std::string& place, const std::string& name) {
  check_ids(found, place, name);
  const auto& refused = found.refused;
  const auto bigger = std::count_if(refused.begin(), refused.end(),
                                    [](const BoardDetection& image) { return image.goes_on; });
  if (bigger > static_cast<long>(found.used.size())) {
    throw Error(place,
                "in " + std::to_string(bigger) + " of " +
                    std::to_string(refused.size() + found.used.size()) +
                    " images the board seems to have more inner corners than the " + name,
                "count them again");
  }
  if (found.used.empty()) {
    throw Error(
        place, "no " + name + " in any image",
        "reason for the first, " + refused.front().image.string() + ": " + refused.front().reason);
  }
}

}  // namespace

std::string text_of(CornerRejection refusal) {
  switch (refusal) {
    case CornerRejection::at_border:
      return "at the image's border";
    case CornerRejection::not_crossing:
      return "occluded or not a crossing of squares";
    case CornerRejection::moved_too_far:
      return "moved out of its search window by refinement";
    case CornerRejection::off_neighbours:
      return "inconsistent with its neighbours";
  }
  return "";
}

std::string rejected_corners_text(const BoardDetection& image) {
  std::map<CornerRejection, int> count;
  for (const RejectedCorner& corner : image.rejected_corners) ++count[corner.why];
  std::string text;
  for (const auto& [why, corners] : count) {
    text += (text.empty() ? "" : ", ") + std::to_string(corners) +
            (corners == 1 ? " corner " : " corners ") + text_of(why);
  }
  return text;
}

BoardDetection detect_board(const std::filesystem::path& image, const BoardTarget& target) {
  check_target(target);
  const cv::Mat grey = read_grey_image(image);
  BoardDetection result;
  result.image = image;
  result.size_px = {grey.cols, grey.rows};
  if (const auto* board = std::get_if<Chessboard>(&target)) {
    detect_chessboard(grey, *board, result);
  } else if (const auto* charuco = std::get_if<CharucoBoard>(&target)) {
    detect_marker_board(grey, *charuco, result);
  } else {
    detect_marker_board(grey, std::get<AprilTagGrid>(target), result);
  }
  return result;
}

std::vector<std::filesystem::path> matching_files(const std::string& pattern) {
  glob_t found{};
  std::vector<std::filesystem::path> files;
  if (::glob(pattern.c_str(), 0, nullptr, &found) == 0) {
    for (std::size_t i = 0; i < found.gl_pathc; ++i) files.emplace_back(found.gl_pathv[i]);
  }
  ::globfree(&found);
  if (files.empty()) {
    throw Error(pattern, "no file matches", "quote the pattern and check the folder");
  }
  return files;
}

ImageDetections detect_images(const std::vector<std::string>& patterns, const BoardTarget& target) {
  check_target(target);
  std::vector<std::vector<std::filesystem::path>> images;
  images.reserve(patterns.size());
  for (const std::string& pattern : patterns) images.push_back(matching_files(pattern));
  const FrameNumbering numbering(frame_numbers(images));
  ImageDetections result;
  result.observations.target_m = target_points(target);
  result.observations.size_px.assign(images.size(), Eigen::Vector2i::Zero());
  for (std::size_t camera = 0; camera < images.size(); ++camera) {
    std::optional<Error> first_fault;
    for (const auto& image : images[camera]) {
      BoardDetection found = detect_or_refuse(image, target, first_fault);
      found.camera = static_cast<int>(camera);
      found.frame = numbering.frame(parse_image_name(image).frame);
      add_detection(found, result);
    }
    if (result.observations.size_px[camera] == Eigen::Vector2i::Zero()) throw *first_fault;
  }
  check_found(result, patterns.front(), name_of(target));
  check_and_sort(result.observations);
  return result;
}

void write_corners(const ImageDetections& found,
                   const BoardTarget& target,
                   const std::filesystem::path& file) {
  BoardObservations all = found.observations;
  for (const BoardDetection& image : found.refused) all.views.push_back(view_of(image));
  write_corners(all, target, file);
}

}  // namespace vernier
