// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/random.h"

namespace vernier::test {

using namespace vernier::internal;

/// A plane n·X = 1 of the first camera's frame, covered with squares of random grey and random
/// size.
struct TexturedPlane {
  Eigen::Vector3d normal{0.05, -0.1, 0.5};
  double square_m = 0.06;
  std::uint64_t seed = 1;

  double grey(const Eigen::Vector3d& X) const {
    const double turned_x = 0.96 * X.x() + 0.28 * X.y(), turned_y = -0.28 * X.x() + 0.96 * X.y();
    const auto column = static_cast<std::uint32_t>(std::floor(turned_x / square_m) + 1000);
    // each column has its rows in other places
    const double shift = RandomStream({.seed = seed, .trial = column, .source = 202}).uniform();
    const auto row = static_cast<std::uint32_t>(std::floor(turned_y / square_m + shift) + 1000);
    return RandomStream({.seed = seed, .trial = column, .feature = row, .source = 203})
        .uniform(30, 220);
  }

  /// The point seen at a pixel of a camera at T_camera_first.
  Eigen::Vector3d point(const Camera& camera, const Pose& T, const Eigen::Vector2d& pixel) const {
    const Pose T_first_camera = T.inverse();
    const Eigen::Vector3d ray = T_first_camera.R * unproject(camera, pixel);
    return T_first_camera.t + ray * (1 - normal.dot(T_first_camera.t)) / normal.dot(ray);
  }
};

/// What a camera of the rig sees: 3 x 3 samples a pixel behind a point spread of about 0.5 px.
/// CV_32F.
template <class Plane>
cv::Mat photograph(const Plane& plane, const Rig& rig, int camera) {
  constexpr int fine = 3;
  const Camera& c = rig.cameras[camera];
  cv::Mat image(fine * c.size_px[1], fine * c.size_px[0], CV_32F), pixels;
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const Eigen::Vector2d pixel((x + 0.5) / fine - 0.5, (y + 0.5) / fine - 0.5);
      image.at<float>(y, x) =
          static_cast<float>(plane.grey(plane.point(c, rig.T_camera_first[camera], pixel)));
    }
  }
  cv::GaussianBlur(image, image, {0, 0}, 0.5 * fine);
  cv::resize(image, pixels, {c.size_px[0], c.size_px[1]}, 0, 0, cv::INTER_AREA);
  return pixels;
}

}  // namespace vernier::test
