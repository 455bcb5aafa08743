// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/board_target.h"

namespace vernier::test {

/// A camera before a board's plane z = 0: pinhole with one radial coefficient, or equidistant.
struct BoardCamera {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  ///< T_camera_board
  Eigen::Vector3d t{0, 0, 1};
  double f_px = 525, k1 = 0;
  int width_px = 640, height_px = 480;
  bool fisheye = false;  ///< radius proportional to the angle from the axis; k1 is not used

  Eigen::Vector2d centre() const { return {0.5 * (width_px - 1), 0.5 * (height_px - 1)}; }

  Eigen::Vector2d pixel_of(const Eigen::Vector3d& X) const {
    const Eigen::Vector2d x = (R * X + t).hnormalized();
    if (fisheye) return f_px * std::atan(x.norm()) * x.normalized() + centre();
    return f_px * (1 + k1 * x.squaredNorm()) * x + centre();
  }

  Eigen::Vector2d board_point_at(const Eigen::Vector2d& pixel) const {
    const Eigen::Vector2d d = (pixel - centre()) / f_px;
    Eigen::Vector2d x = d;
    for (int i = 0; k1 != 0 && i < 30 && !fisheye; ++i) x = d / (1 + k1 * x.squaredNorm());
    if (fisheye) x = std::tan(d.norm()) * d.normalized();
    Eigen::Matrix3d H;  // columns of R for x and y, and t: plane to camera
    H << R.col(0), R.col(1), t;
    return (H.inverse() * x.homogeneous()).hnormalized();
  }
};

/// Looks at `middle` of the board from `distance`, the board tilted about x, y and turned about z.
inline BoardCamera camera_before(
    const Eigen::Vector2d& middle, double distance, double tilt_x, double tilt_y, double turn) {
  BoardCamera camera;
  camera.R = (Eigen::AngleAxisd(tilt_x, Eigen::Vector3d::UnitX()) *
              Eigen::AngleAxisd(tilt_y, Eigen::Vector3d::UnitY()) *
              Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()))
                 .toRotationMatrix();
  camera.t =
      Eigen::Vector3d(0, 0, distance) - camera.R * Eigen::Vector3d(middle.x(), middle.y(), 0);
  return camera;
}

/// A board's grey values by the place on its plane, metres.
using BoardDrawing = std::function<double(const Eigen::Vector2d&)>;

constexpr double paper = 220, ink = 25;

inline BoardDrawing draw(const Chessboard& board) {
  const double row_m = board.row_m > 0 ? board.row_m : board.square_m;
  return [=](const Eigen::Vector2d& p) {
    const int column = static_cast<int>(std::floor(p.x() / board.square_m));
    const int row = static_cast<int>(std::floor(p.y() / row_m));
    if (column < -1 || row < -1 || column >= board.columns || row >= board.rows) return paper;
    return (column + row) % 2 == 0 ? ink : paper;
  };
}

/// As OpenCV itself draws it; in the frame of target_points, first inner corner at the origin.
inline BoardDrawing draw(const CharucoBoard& board, int opencv_dictionary) {
  constexpr int pixels = 96;  // a square
  cv::Mat image;
  cv::aruco::CharucoBoard::create(board.columns, board.rows, float(board.square_m),
                                  float(board.marker_m),
                                  cv::aruco::getPredefinedDictionary(opencv_dictionary))
      ->draw({pixels * board.columns, pixels * board.rows}, image);
  return [=](const Eigen::Vector2d& p) {
    const int x = static_cast<int>(std::floor((p.x() / board.square_m + 1) * pixels));
    const int y = static_cast<int>(std::floor((p.y() / board.square_m + 1) * pixels));
    if (x < 0 || y < 0 || x >= image.cols || y >= image.rows) return paper;
    return image.at<unsigned char>(y, x) > 127 ? paper : ink;
  };
}

/// A tag of family 36h11 as its code says: 36 bits row by row from the upper left, highest first.
inline std::uint64_t code_36h11(int id) {
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11);
  const cv::Mat bits = cv::aruco::Dictionary::getBitsFromByteList(dictionary->bytesList.row(id), 6);
  std::uint64_t code = 0;  // OpenCV's drawing is half a turn from the code's
  for (int i = 35; i >= 0; --i) code = code << 1 | bits.at<unsigned char>(i / 6, i % 6);
  return code;
}

/// As Kalibr prints it: tags upright, tag 0 at the lower left, and (`squares`) a black square in
/// every gap's crossing.
inline BoardDrawing draw(const AprilTagGrid& grid, int border_bits, bool squares = true) {
  const double pitch = grid.tag_m * (1 + grid.spacing);
  const int cells = 6 + 2 * border_bits;
  std::vector<std::uint64_t> codes;
  for (int id = 0; id < grid.columns * grid.rows; ++id) codes.push_back(code_36h11(id));
  return [=](const Eigen::Vector2d& p) {
    const int column = static_cast<int>(std::floor(p.x() / pitch));
    const int row = static_cast<int>(std::floor(p.y() / pitch));
    const double u = p.x() - column * pitch, v = p.y() - row * pitch;
    const bool near = column >= -1 && row >= -1 && column < grid.columns && row < grid.rows;
    if (near && u >= grid.tag_m && v >= grid.tag_m) return squares ? ink : paper;
    if (!near || column < 0 || row < 0 || u >= grid.tag_m || v >= grid.tag_m) return paper;
    const int c = static_cast<int>(u / grid.tag_m * cells) - border_bits;
    const int r = static_cast<int>((1 - v / grid.tag_m) * cells) - border_bits;
    if (c < 0 || r < 0 || c >= 6 || r >= 6) return ink;
    const int counted = grid.top_row_first ? grid.rows - 1 - row : row;
    return codes[counted * grid.columns + column] >> (35 - 6 * r - c) & 1 ? paper : ink;
  };
}

struct ImageQuality {
  double blur_px = 0.7, noise = 2;
};

/// 16 samples a pixel, then blur and white noise.
inline cv::Mat photograph(const BoardDrawing& drawing,
                          const BoardCamera& camera,
                          const ImageQuality& quality = {}) {
  cv::Mat image(camera.height_px, camera.width_px, CV_32F);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      double sum = 0;
      for (int s = 0; s < 16; ++s) {
        const Eigen::Vector2d offset(0.25 * (s % 4) - 0.375, 0.25 * (s / 4) - 0.375);
        sum += drawing(camera.board_point_at(Eigen::Vector2d(x, y) + offset));
      }
      image.at<float>(y, x) = static_cast<float>(sum / 16);
    }
  }
  if (quality.blur_px > 0) cv::GaussianBlur(image, image, {0, 0}, quality.blur_px);
  cv::Mat noise(image.size(), CV_32F), grey;
  cv::RNG(1).fill(noise, cv::RNG::NORMAL, 0, quality.noise);
  cv::Mat(image + noise).convertTo(grey, CV_8U);
  return grey;
}

}  // namespace vernier::test
