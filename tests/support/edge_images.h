// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "calib/statistics/random.h"
#include "stereo/grey_levels.h"

namespace vernier::test {

using namespace vernier::internal;
using namespace vernier::stereo;

/// A straight edge from dark to bright: brighter where nᵀ(x − centre) > offset, n at `angle` from
/// the x axis.
struct Step {
  Eigen::Vector2d centre{0, 0};
  double angle = 0, offset_px = 0, blur_px = 0.8, dark = 90, bright = 150;

  Eigen::Vector2d normal() const { return {std::cos(angle), std::sin(angle)}; }
  /// Of a point from the edge, positive on the bright side.
  double distance(const Eigen::Vector2d& p) const { return normal().dot(p - centre) - offset_px; }
  /// Grey level behind a Gaussian point spread.
  double level(const Eigen::Vector2d& p) const {
    return dark + (bright - dark) * 0.5 * std::erfc(-distance(p) / (blur_px * std::numbers::sqrt2));
  }
};

/// Means over the pixels' squares (5 x 5 samples). No noise, not rounded.
inline GreyLevels sampled(int width,
                          int height,
                          const std::function<double(const Eigen::Vector2d&)>& level) {
  constexpr int fine = 5;
  GreyLevels image{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      for (int j = 0; j < fine; ++j) {
        for (int i = 0; i < fine; ++i) {
          sum += level({x + (i + 0.5) / fine - 0.5, y + (j + 0.5) / fine - 0.5});
        }
      }
      image.values.push_back(static_cast<float>(sum / (fine * fine)));
    }
  }
  return image;
}

/// Flat regions seen by a camera: pixels integrate over their squares (8 x 8 samples) behind a
/// Gaussian point spread. No noise, not rounded.
inline GreyLevels photographed(int width,
                               int height,
                               double blur_px,
                               const std::function<double(const Eigen::Vector2d&)>& level) {
  constexpr int fine = 8;
  cv::Mat image(fine * height, fine * width, CV_32F), pixels;
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      image.at<float>(y, x) =
          static_cast<float>(level({(x + 0.5) / fine - 0.5, (y + 0.5) / fine - 0.5}));
    }
  }
  cv::GaussianBlur(image, image, {0, 0}, fine * blur_px, 0, cv::BORDER_REPLICATE);
  cv::resize(image, pixels, {width, height}, 0, 0, cv::INTER_AREA);
  return {width, height, {pixels.begin<float>(), pixels.end<float>()}};
}

/// With white noise, rounded to whole grey levels from 0 to 255.
inline GreyLevels with_noise(GreyLevels image, double sigma, RandomStream& draws) {
  for (float& value : image.values) {
    value = std::clamp(std::round(value + static_cast<float>(sigma * draws.normal())), 0.F, 255.F);
  }
  return image;
}

/// A convex polygon, its corners clockwise as seen (y down).
struct ConvexPolygon {
  std::vector<Eigen::Vector2d> corners;

  bool holds(const Eigen::Vector2d& p) const {
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Eigen::Vector2d side = corners[(k + 1) % corners.size()] - corners[k];
      const Eigen::Vector2d to = p - corners[k];
      if (side.x() * to.y() - side.y() * to.x() < 0) return false;
    }
    return true;
  }
};

/// Of three to six corners about `centre`, at 50 to 65 px from it.
inline ConvexPolygon random_polygon(const Eigen::Vector2d& centre, RandomStream& draws) {
  ConvexPolygon polygon;
  const int corners = 3 + static_cast<int>(draws.below(4));
  const double turn = draws.uniform(0, 2 * std::numbers::pi);
  for (int k = 0; k < corners; ++k) {
    const double angle = turn + 2 * std::numbers::pi * (k + draws.uniform(-0.12, 0.12)) / corners;
    polygon.corners.push_back(centre + draws.uniform(50, 65) *
                                           Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return polygon;
}

}  // namespace vernier::test
