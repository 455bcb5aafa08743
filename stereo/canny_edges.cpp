// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/canny_edges.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "calib/error.h"
#include "stereo/edge_places.h"
#include "stereo/image_gradient.h"
#include "stereo/image_noise.h"

namespace vernier {
namespace {

constexpr int strip = 48;  // rows at a time, for the processor's cache

/// Sets of connected points; the first of each is its root.
class ConnectedSets {
 public:
  int add() {
    parents_.push_back(static_cast<int>(parents_.size()));
    return parents_.back();
  }
  int root(int i) {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
    return i;
  }
  void join(int a, int b) {
    a = root(a);
    b = root(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<int> parents_;
};

/// For every pixel of a row whether its |g| is at least `low` and the largest along g: larger than
/// on the one side and no smaller than on the other, by interpolation between the two pixels that g
/// passes one row (or column, whichever g is steeper to) away. All products with |g_x| or |g_y|, so
/// that nothing is divided, and no branches, so that the compiler makes vectors.
void find_peaks_in_row(const GradientRows& gradient, int row, float low, std::vector<int>& found) {
  const float* const gx = gradient.x.ptr<float>(row);
  const float* const gy = gradient.y.ptr<float>(row);
  const float* const above = gradient.strength.ptr<float>(row - 1);
  const float* const at = gradient.strength.ptr<float>(row);
  const float* const below = gradient.strength.ptr<float>(row + 1);
  int* const peak = found.data();
  for (int x = 1; x < gradient.x.cols - 1; ++x) {
    const float nw = above[x - 1], n = above[x], ne = above[x + 1], w = at[x - 1], own = at[x],
                e = at[x + 1], sw = below[x - 1], s = below[x], se = below[x + 1];
    const float along_x = std::abs(gx[x]), along_y = std::abs(gy[x]);
    const bool falls = gx[x] * gy[x] >= 0;  // g is to the right and down, or to the left and up
    const bool steep = along_x < along_y;
    const float major = std::max(along_x, along_y), minor = std::min(along_x, along_y);
    const float one = steep ? s : e, other = steep ? n : w;
    const float right = falls ? se : ne, left = falls ? nw : sw;
    const float one_aside = steep ? (falls ? se : sw) : right;
    const float other_aside = steep ? (falls ? nw : ne) : left;
    const float one_side = (major - minor) * one + minor * one_aside;
    const float other_side = (major - minor) * other + minor * other_aside;
    peak[x] = (own * major > one_side) & (own * major >= other_side) & (own >= low) ? 1 : 0;
  }
}

/// Peaks of |g| across edges, row by row, and which of them are connected.
class PeakFinder {
 public:
  PeakFinder(int columns, const CannyOptions& options)
      : options_(options),
        border_(border_px(options)),
        is_peak_(columns, 0),
        own_(columns, -1),
        above_(columns, -1) {}

  /// No points nearer to the image's border, where what is beyond it would displace them.
  static int border_px(const CannyOptions& options) {
    return std::max(1, static_cast<int>(std::ceil(2 * options.scale_px)));
  }

  /// Rows have to come one after the other.
  void add_row(const GradientRows& gradient, int y, std::vector<EdgePoint>& peaks) {
    const int row = y - gradient.first_row, columns = gradient.x.cols;
    find_peaks_in_row(gradient, row, static_cast<float>(options_.low), is_peak_);
    std::fill(own_.begin(), own_.end(), -1);
    for (int x = border_; x < columns - border_; ++x) {
      if (is_peak_[x] == 0) continue;
      own_[x] = sets_.add();
      for (const int other : {own_[x - 1], above_[x - 1], above_[x], above_[x + 1]}) {
        if (other >= 0) sets_.join(own_[x], other);
      }
      EdgePoint& peak = peaks.emplace_back();
      peak.x = x;
      peak.y = y;
    }
    std::swap(above_, own_);
  }

  ConnectedSets& sets() { return sets_; }

 private:
  const CannyOptions& options_;
  int border_;
  std::vector<int> is_peak_, own_, above_;
  ConnectedSets sets_;
};

/// Keeps the points of strings with a strong one and enough of them, and numbers the strings in the
/// order of their first points.
void keep_strings(ConnectedSets& sets,
                  const CannyOptions& options,
                  std::vector<EdgePoint>& points) {
  struct Members {
    int count = 0, number = -1;
    bool strong = false;
  };
  std::vector<Members> of_root(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    Members& string = of_root[sets.root(static_cast<int>(i))];
    ++string.count;
    string.strong |= points[i].strength >= options.high;
  }
  std::size_t kept = 0;
  int next = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Members& string = of_root[sets.root(static_cast<int>(i))];
    if (!string.strong || string.count < options.least_points) continue;
    if (string.number < 0) string.number = next++;
    points[kept] = points[i];
    points[kept++].string = string.number;
  }
  points.resize(kept);
}

void check(const GreyLevels& image, const CannyOptions& options) {
  const auto values = static_cast<std::size_t>(std::max(0, image.width_px)) *
                      static_cast<std::size_t>(std::max(0, image.height_px));
  if (image.width_px < 0 || image.height_px < 0 || image.values.size() != values) {
    throw Error("canny_edges", "the image's values do not fill its size",
                "give width times height of them");
  }
  if (!(options.scale_px >= 0.5 && options.scale_px <= 20)) {
    throw Error("canny_edges", "the scale is not between 0.5 and 20 px", "choose one near 1 px");
  }
  if (!(options.low > 0 && options.high >= options.low)) {
    throw Error("canny_edges", "the thresholds are not 0 < low <= high", "choose 2 and 5, say");
  }
}

}  // namespace

std::vector<EdgePoint> canny_edges(const GreyLevels& image, const CannyOptions& options) {
  check(image, options);
  const GradientKernel kernel(options.scale_px);
  if (std::min(image.width_px, image.height_px) <= 2 * kernel.reach) return {};
  const cv::Mat grey(image.height_px, image.width_px, CV_32F,
                     const_cast<float*>(image.values.data()));
  const EdgePlaces places(kernel, image_noise(grey));
  PeakFinder finder(grey.cols, options);
  GradientRows gradient;
  std::vector<EdgePoint> edges;
  edges.reserve(image.values.size() / 4);
  const int border = PeakFinder::border_px(options);
  for (int first = border; first < grey.rows - border; first += strip) {
    const int end = std::min(first + strip, grey.rows - border);
    gradient.compute(grey, kernel, first - 1, end + 1);
    const std::size_t before = edges.size();
    for (int y = first; y < end; ++y) finder.add_row(gradient, y, edges);
    places.place(gradient, std::span(edges).subspan(before));
  }
  keep_strings(finder.sets(), options, edges);
  return edges;
}

}  // namespace vernier
