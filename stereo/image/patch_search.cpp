// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/image/patch_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>

namespace vernier::stereo::internal {
namespace {

constexpr float flat_variance = 4;  // grey levels²; patches below have no texture
constexpr int min_distance_px = 2;  // the second best must be farther from the best

bool is_inside(const cv::Mat& image, cv::Point centre, int half) {
  return centre.x >= half && centre.y >= half && centre.x + half < image.cols &&
         centre.y + half < image.rows;
}

struct Moments {
  float mean = 0, deviation = 0;
  bool flat() const { return !(deviation * deviation > flat_variance); }
};

Moments moments(const cv::Mat& image, cv::Point centre, int half) {
  cv::Scalar mean, deviation;
  const int side = 2 * half + 1;
  cv::meanStdDev(image(cv::Rect(centre.x - half, centre.y - half, side, side)), mean, deviation);
  return {static_cast<float>(mean[0]), static_cast<float>(deviation[0])};
}

/// Vertex of a parabola through three scores, relative to the middle one.
double peak_offset(float before, float at, float after) {
  const double bend = static_cast<double>(before) - 2.0 * at + after;
  if (!(bend < 0)) return 0;
  return std::clamp(0.5 * (static_cast<double>(before) - after) / bend, -0.5, 0.5);
}

}  // namespace

bool has_texture(const cv::Mat& image, cv::Point centre, int half_px) {
  return is_inside(image, centre, half_px) && !moments(image, centre, half_px).flat();
}

PatchSearch::PatchSearch(const cv::Mat& image, int half_px) : image_(image), half_(half_px) {
  const cv::Size side(2 * half_px + 1, 2 * half_px + 1);
  cv::Mat squares;
  cv::boxFilter(image, mean_, CV_32F, side);
  cv::sqrBoxFilter(image, squares, CV_32F, side);
  inverse_length_ = cv::Mat::zeros(image.size(), CV_32F);
  const auto pixels = static_cast<float>(side.area());
  for (int y = 0; y < image.rows; ++y) {
    const float *mean = mean_.ptr<float>(y), *square = squares.ptr<float>(y);
    float* inverse = inverse_length_.ptr<float>(y);
    for (int x = 0; x < image.cols; ++x) {
      const float variance = square[x] - mean[x] * mean[x];
      inverse[x] = variance > flat_variance ? 1 / std::sqrt(pixels * variance) : 0;
    }
  }
}

/// Scores of the window, before division by the patch's own norm.
void PatchSearch::correlate(const cv::Mat& other,
                            cv::Point centre,
                            float mean,
                            const SearchWindow& w) {
  const int columns = w.max_x - w.min_x + 1, rows = w.max_y - w.min_y + 1;
  scores_.assign(static_cast<std::size_t>(columns) * rows, 0);
  for (int row = 0; row < rows; ++row) {
    float* scores = scores_.data() + static_cast<std::size_t>(row) * columns;
    for (int j = -half_; j <= half_; ++j) {
      const float* patch = other.ptr<float>(centre.y + j) + centre.x;
      const float* image = image_.ptr<float>(w.min_y + row + j) + w.min_x;
      for (int i = -half_; i <= half_; ++i) {
        const float grey = patch[i] - mean;
        const float* from = image + i;
        for (int x = 0; x < columns; ++x) scores[x] += grey * from[x];
      }
    }
    const float* inverse = inverse_length_.ptr<float>(w.min_y + row) + w.min_x;
    for (int x = 0; x < columns; ++x) scores[x] *= inverse[x];
  }
}

std::optional<FoundPatch> PatchSearch::find(const cv::Mat& other,
                                            cv::Point centre,
                                            SearchWindow w) {
  if (!has_texture(other, centre, half_)) return std::nullopt;
  w.min_x = std::max(w.min_x, half_);
  w.min_y = std::max(w.min_y, half_);
  w.max_x = std::min(w.max_x, image_.cols - 1 - half_);
  w.max_y = std::min(w.max_y, image_.rows - 1 - half_);
  if (w.min_x > w.max_x || w.min_y > w.max_y) return std::nullopt;

  const Moments own = moments(other, centre, half_);
  correlate(other, centre, own.mean, w);
  const float inverse = 1 / (static_cast<float>(2 * half_ + 1) * own.deviation);
  const int columns = w.max_x - w.min_x + 1, rows = w.max_y - w.min_y + 1;
  const auto best =
      static_cast<int>(std::max_element(scores_.begin(), scores_.end()) - scores_.begin());
  const int bx = best % columns, by = best / columns;
  const auto at = [&](int x, int y) { return scores_[static_cast<std::size_t>(y) * columns + x]; };
  FoundPatch found{{w.min_x + bx, w.min_y + by}, {}, inverse * at(bx, by)};
  found.peak_px = {found.pixel.x + 0.0, found.pixel.y + 0.0};
  if (bx > 0 && bx + 1 < columns) {
    found.peak_px.x() += peak_offset(at(bx - 1, by), at(bx, by), at(bx + 1, by));
  }
  if (by > 0 && by + 1 < rows) {
    found.peak_px.y() += peak_offset(at(bx, by - 1), at(bx, by), at(bx, by + 1));
  }
  for (int y = 0; y < rows; ++y) {
    const bool near_row = std::abs(y - by) <= min_distance_px;
    for (int x = 0; x < columns; ++x) {
      if (near_row && std::abs(x - bx) <= min_distance_px) continue;
      found.second = std::max(found.second, inverse * at(x, y));
    }
  }
  return found;
}

}  // namespace vernier::stereo::internal
