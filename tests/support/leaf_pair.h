// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "stereo/grey_levels.h"

namespace vernier::test {

using namespace vernier::internal;
using namespace vernier::stereo;

/// A plane covered with leaves of two grey levels, one above the other: every edge has the whole
/// contrast.
struct LeafPlane {
  int width_px = 320, height_px = 240;
  double disparity_px = 20, by_x = 0, by_y = 0;  ///< in the middle, and per left pixel
  double contrast = 60, noise = 2, point_spread_px = 0.8;
  double min_radius_px = 4, max_radius_px = 30;

  double disparity_at(double x, double y) const {
    return disparity_px + by_x * (x - 0.5 * width_px) + by_y * (y - 0.5 * height_px);
  }
};

/// The leaves as they lie in the left image's plane, `fine` samples a pixel and margins about.
class LeafTexture {
 public:
  LeafTexture(const LeafPlane& plane, RandomStream& draws) {
    texture_.create((plane.height_px + 2 * margin) * fine, (plane.width_px + 2 * wide) * fine,
                    CV_32F);
    texture_.setTo(128);
    const double area = static_cast<double>(texture_.total()) / (fine * fine);
    const int leaves = static_cast<int>(0.06 * area);
    for (int i = 0; i < leaves; ++i) {
      const double share = std::pow(draws.uniform(), 3);
      const double radius =
          plane.min_radius_px + (plane.max_radius_px - plane.min_radius_px) * share;
      const double cx = draws.uniform() * texture_.cols, cy = draws.uniform() * texture_.rows;
      const int corners = 3 + static_cast<int>(4 * draws.uniform());
      const double turn = 2 * M_PI * draws.uniform();
      std::vector<cv::Point> leaf;
      for (int k = 0; k < corners; ++k) {
        const double angle = turn + 2 * M_PI * k / corners;
        leaf.emplace_back(cvRound(cx + fine * radius * std::cos(angle)),
                          cvRound(cy + fine * radius * std::sin(angle)));
      }
      const double side = draws.uniform() < 0.5 ? -0.5 : 0.5;
      cv::fillConvexPoly(texture_, leaf, cv::Scalar(128 + side * plane.contrast));
    }
  }

  /// Linear along the row, for the disparity not to be rounded to fine samples.
  float at(double x, double y) const {
    const double u = (x + wide + 0.5) * fine - 0.5;
    const int row =
        std::clamp(static_cast<int>(std::floor((y + margin + 0.5) * fine)), 0, texture_.rows - 1);
    const int left = std::clamp(static_cast<int>(std::floor(u)), 0, texture_.cols - 2);
    const auto t = static_cast<float>(std::clamp(u - left, 0.0, 1.0));
    return (1 - t) * texture_.at<float>(row, left) + t * texture_.at<float>(row, left + 1);
  }

  static constexpr int fine = 4, margin = 20, wide = 200;

 private:
  cv::Mat texture_;
};

/// The pair as two cameras see it: point spread and pixels as large as the raster's, noise, whole
/// grey levels.
inline RectifiedPair leaf_pair(const LeafPlane& plane, std::uint64_t seed) {
  RandomStream draws({.seed = seed, .source = static_cast<std::uint32_t>(DrawSource::noisy_copy)});
  const LeafTexture texture(plane, draws);
  constexpr int fine = LeafTexture::fine;
  RectifiedPair pair;
  for (const bool is_left : {true, false}) {
    cv::Mat view(plane.height_px * fine, plane.width_px * fine, CV_32F);
    for (int j = 0; j < view.rows; ++j) {
      for (int i = 0; i < view.cols; ++i) {
        const double u = (i + 0.5) / fine - 0.5, v = (j + 0.5) / fine - 0.5;
        // u = x − d(x, v) solved for x.
        const double x = is_left ? u
                                 : (u + plane.disparity_px - plane.by_x * 0.5 * plane.width_px +
                                    plane.by_y * (v - 0.5 * plane.height_px)) /
                                       (1 - plane.by_x);
        view.at<float>(j, i) = texture.at(x, v);
      }
    }
    cv::GaussianBlur(view, view, {0, 0}, plane.point_spread_px * fine);
    cv::resize(view, view, {plane.width_px, plane.height_px}, 0, 0, cv::INTER_AREA);
    GreyLevels& image = is_left ? pair.left : pair.right;
    image = {plane.width_px, plane.height_px, {}};
    for (int y = 0; y < plane.height_px; ++y) {
      for (int x = 0; x < plane.width_px; ++x) {
        const double value = view.at<float>(y, x) + plane.noise * draws.normal();
        image.values.push_back(static_cast<float>(std::clamp(std::round(value), 0.0, 255.0)));
      }
    }
  }
  return pair;
}

}  // namespace vernier::test
