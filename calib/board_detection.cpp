// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board_detection.h"

#include <glob.h>

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "calib/error.h"
#include "calib/observations_file.h"

namespace vernier {
namespace {

/// Mean grey value of the middle of a square given by its corners.
double square_brightness(const cv::Mat& grey,
                         const cv::Point2f& a,
                         const cv::Point2f& b,
                         const cv::Point2f& c,
                         const cv::Point2f& d) {
  double sum = 0;
  int count = 0;
  for (double s = 0.3; s < 0.75; s += 0.1) {
    for (double t = 0.3; t < 0.75; t += 0.1) {
      const cv::Point2d p = cv::Point2d(a) * (1 - s) * (1 - t) + cv::Point2d(b) * s * (1 - t) +
                            cv::Point2d(c) * s * t + cv::Point2d(d) * (1 - s) * t;
      const int x = std::clamp(cvRound(p.x), 0, grey.cols - 1);
      const int y = std::clamp(cvRound(p.y), 0, grey.rows - 1);
      sum += grey.at<unsigned char>(y, x);
      ++count;
    }
  }
  return sum / count;
}

/// Makes the first square dark by a half turn where that changes its colour.
void make_order_unique(const cv::Mat& grey,
                       const Chessboard& board,
                       std::vector<cv::Point2f>& corners) {
  if ((board.columns + board.rows) % 2 == 0) return;
  const int n = board.columns;
  const double first = square_brightness(grey, corners[0], corners[1], corners[n + 1], corners[n]);
  const double beside =
      square_brightness(grey, corners[1], corners[2], corners[n + 2], corners[n + 1]);
  if (first > beside) std::reverse(corners.begin(), corners.end());
}

double smallest_spacing(const std::vector<cv::Point2f>& corners, const Chessboard& board) {
  double least = 1e9;
  for (int r = 0; r < board.rows; ++r) {
    for (int c = 0; c < board.columns; ++c) {
      const int i = r * board.columns + c;
      if (c + 1 < board.columns) least = std::min(least, cv::norm(corners[i] - corners[i + 1]));
      if (r + 1 < board.rows) {
        least = std::min(least, cv::norm(corners[i] - corners[i + board.columns]));
      }
    }
  }
  return least;
}

bool find_corners(const cv::Mat& grey, const Chessboard& board, std::vector<cv::Point2f>& corners) {
  const cv::Size size(board.columns, board.rows);
  if (cv::findChessboardCorners(grey, size, corners,
                                cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE)) {
    return true;
  }
  return cv::findChessboardCornersSB(grey, size, corners,
                                     cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE);
}

BoardView view_of(const BoardDetection& found) {
  BoardView view;
  view.frame = parse_image_name(found.image).frame;
  view.camera = found.camera;
  view.image = found.image.string();  // with its folder, which may be what tells the cameras apart
  view.pixels_px = found.corners_px;
  for (std::size_t i = 0; i < found.corners_px.size(); ++i) view.ids.push_back(static_cast<int>(i));
  return view;
}

/// Throws Error where a camera has no frame number in common with the cameras before it.
void check_frames_meet(const std::vector<std::vector<std::filesystem::path>>& images) {
  std::set<int> before;
  for (std::size_t camera = 0; camera < images.size(); ++camera) {
    std::set<int> frames;
    for (const auto& image : images[camera]) frames.insert(parse_image_name(image).frame);
    const auto met = [&](int frame) { return before.count(frame) > 0; };
    if (camera > 0 && std::none_of(frames.begin(), frames.end(), met)) {
      const auto& first = images.front().front();
      const auto& own = images[camera].front();
      throw Error(own.string(),
                  "no image of its camera has the frame number of an image before it (here " +
                      std::to_string(parse_image_name(own).frame) + ", " +
                      std::to_string(parse_image_name(first).frame) + " in " + first.string() + ")",
                  "the last number in a name is the frame; give simultaneous images the same");
    }
    before.insert(frames.begin(), frames.end());
  }
}

void add_detection(const BoardDetection& found, ImageDetections& result) {
  auto& size = result.observations.size_px[found.camera];
  if (size == Eigen::Vector2i::Zero()) size = found.size_px;
  if (size != found.size_px) {
    throw Error(found.image.string(),
                "its size " + std::to_string(found.size_px[0]) + "x" +
                    std::to_string(found.size_px[1]) + " differs from the images before it (" +
                    std::to_string(size[0]) + "x" + std::to_string(size[1]) + ")",
                "give images of one size a camera");
  }
  if (found.corners_px.empty()) {
    result.refused.push_back(found);
    return;
  }
  result.observations.views.push_back(view_of(found));
}

}  // namespace

BoardDetection detect_board(const std::filesystem::path& image, const Chessboard& board) {
  if (board.columns < 3 || board.rows < 3) {
    throw Error("board " + std::to_string(board.columns) + "x" + std::to_string(board.rows),
                "fewer than 3 inner corners along a side",
                "count the inner corners, not the squares");
  }
  const cv::Mat grey = cv::imread(image.string(), cv::IMREAD_GRAYSCALE);
  if (grey.empty()) {
    throw Error(image.string(), "is not an image that can be read", "check the file");
  }
  BoardDetection result{image, {grey.cols, grey.rows}, {}, "", 0};
  std::vector<cv::Point2f> corners;
  if (!find_corners(grey, board, corners)) {
    result.reason =
        "no " + std::to_string(board.columns) + "x" + std::to_string(board.rows) + " board found";
    return result;
  }
  const int half = std::clamp(static_cast<int>(0.35 * smallest_spacing(corners, board)), 2, 11);
  cv::cornerSubPix(grey, corners, {half, half}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-4});
  make_order_unique(grey, board, corners);
  for (const cv::Point2f& corner : corners) result.corners_px.emplace_back(corner.x, corner.y);
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

ImageDetections detect_images(const std::vector<std::string>& patterns, const Chessboard& board) {
  std::vector<std::vector<std::filesystem::path>> images;
  for (const std::string& pattern : patterns) images.push_back(matching_files(pattern));
  check_frames_meet(images);
  ImageDetections result;
  result.observations.target_m = target_points(board);
  result.observations.size_px.assign(images.size(), Eigen::Vector2i::Zero());
  for (std::size_t camera = 0; camera < images.size(); ++camera) {
    for (const auto& image : images[camera]) {
      BoardDetection found = detect_board(image, board);
      found.camera = static_cast<int>(camera);
      add_detection(found, result);
    }
  }
  if (result.observations.views.empty()) {
    throw Error(patterns.front(),
                "no board of " + std::to_string(board.columns) + "x" + std::to_string(board.rows) +
                    " inner corners in any image",
                "check --board (inner corners, not squares) and look at the images");
  }
  check_and_sort(result.observations);
  return result;
}

void write_corners(const ImageDetections& found,
                   const Chessboard& board,
                   const std::filesystem::path& file) {
  BoardObservations all = found.observations;
  for (const BoardDetection& image : found.refused) all.views.push_back(view_of(image));
  write_corners(all, board, file);
}

}  // namespace vernier
