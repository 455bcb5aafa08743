// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/canny_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

#include "calib/error.h"
#include "stereo/edges/connected_sets.h"
#include "stereo/edges/edge_places.h"
#include "stereo/grey_levels.h"
#include "stereo/image/image_gradient.h"
#include "stereo/image/image_noise.h"
#include "stereo/image/matrix_of.h"

namespace vernier::stereo {

using namespace internal;

namespace {

constexpr int strip = 48;  // rows at a time, for cache locality

enum GradientPeak : int { no_peak = 0, weak_peak = 1, sharp_peak = 2 };

/// For every pixel of a row, whether its |g| is at least `low` and a maximum along g: larger than
/// on one side and no smaller than on the other, interpolated between the two pixels that g crosses
/// one row away (or column, whichever g is steeper to). A sharp peak is a maximum along that row or
/// column too, so a straight edge has one in each. All values are multiplied by |g_x| or |g_y|
/// instead of divided, and there are no branches, so that the compiler can vectorise it.
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
    const bool falls = gx[x] * gy[x] >= 0;  // g points right and down, or left and up
    const bool steep = along_x < along_y;
    const float major = std::max(along_x, along_y), minor = std::min(along_x, along_y);
    const float one = steep ? s : e, other = steep ? n : w;
    const float right = falls ? se : ne, left = falls ? nw : sw;
    const float one_aside = steep ? (falls ? se : sw) : right;
    const float other_aside = steep ? (falls ? nw : ne) : left;
    const float one_side = (major - minor) * one + minor * one_aside;
    const float other_side = (major - minor) * other + minor * other_aside;
    const float across = own * major;
    const int is_peak = (across > one_side) & (across >= other_side) & (own >= low);
    const int is_sharp = (own > one) & (own >= other);
    peak[x] = is_peak + (is_peak & is_sharp);
  }
}

/// Whether the neighbouring peaks among the eight (bits, clockwise from the upper left) stay
/// connected without the pixel, and one of the four nearest is not a peak: then the pixel is
/// redundant.
constexpr bool is_spare(unsigned neighbours) {
  const auto set = [&](unsigned k) { return (neighbours >> (k % 8) & 1U) != 0; };
  int groups = 0;  // runs around; the two neighbours of a corner touch each other
  for (unsigned k = 0; k < 8; k += 2) {
    const bool side = set(k + 1);
    if (!side && (set(k + 2) || set(k + 3))) ++groups;
  }
  const bool surrounded = set(1) && set(3) && set(5) && set(7);
  return !surrounded && groups <= 1;
}

constexpr std::array<bool, 256> spare_table() {
  std::array<bool, 256> table{};
  for (unsigned k = 0; k < 256; ++k) table[k] = is_spare(k);
  return table;
}

/// Peaks of |g| across edges, row by row, and their connections.
class PeakFinder {
 public:
  PeakFinder(cv::Size size, const CannyOptions& options)
      : size_(size),
        options_(options),
        border_(border_px(options)),
        next_row_(border_),
        above_(size.width, no_peak),
        own_(above_),
        below_(above_),
        string_above_(size.width, -1),
        string_(string_above_) {}

  /// No points close to the image border, where the replicated border would displace them.
  static int border_px(const CannyOptions& options) {
    return std::max(2, static_cast<int>(std::ceil(2 * options.scale_px)));
  }

  /// Rows must be processed in order from the border on, with the gradient of two more rows.
  void add_row(const GradientRows& gradient, int y, std::vector<EdgePoint>& peaks) {
    for (; next_row_ <= y + 1; ++next_row_) read(gradient, next_row_);
    thin();
    std::fill(string_.begin(), string_.end(), -1);
    for (int x = border_; x < size_.width - border_; ++x) {
      if (own_[x] == no_peak) continue;
      string_[x] = sets_.add();
      for (const int other :
           {string_[x - 1], string_above_[x - 1], string_above_[x], string_above_[x + 1]}) {
        if (other >= 0) sets_.join(string_[x], other);
      }
      EdgePoint& peak = peaks.emplace_back();
      peak.x = x;
      peak.y = y;
    }
    std::swap(string_above_, string_);
  }

  ConnectedSets& sets() { return sets_; }

 private:
  void read(const GradientRows& gradient, int y) {
    std::swap(above_, own_);
    std::swap(own_, below_);
    if (y >= size_.height - border_) {
      std::fill(below_.begin(), below_.end(), no_peak);
      return;
    }
    find_peaks_in_row(gradient, y - gradient.first_row, static_cast<float>(options_.low), below_);
    std::fill(below_.begin(), below_.begin() + border_, no_peak);
    std::fill(below_.end() - border_, below_.end(), no_peak);
  }

  /// Weak peaks beside sharp ones along slanted edges are kept only where they connect others.
  void thin() {
    static constexpr std::array<bool, 256> spare = spare_table();
    for (int x = border_; x < size_.width - border_; ++x) {
      if (own_[x] != weak_peak) continue;
      const auto bit = [](int peak, unsigned k) { return (peak != no_peak ? 1U : 0U) << k; };
      const unsigned neighbours =
          bit(above_[x - 1], 0) | bit(above_[x], 1) | bit(above_[x + 1], 2) | bit(own_[x + 1], 3) |
          bit(below_[x + 1], 4) | bit(below_[x], 5) | bit(below_[x - 1], 6) | bit(own_[x - 1], 7);
      if (spare[neighbours]) own_[x] = no_peak;
    }
  }

  cv::Size size_;
  const CannyOptions& options_;
  int border_, next_row_;
  std::vector<int> above_, own_, below_;
  std::vector<int> string_above_, string_;
  ConnectedSets sets_;
};

/// Keeps the edges with a strong point and enough points, and numbers them in the order of their
/// first points.
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
    if (!string.strong || string.count < options.min_points) continue;
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
    throw Error("canny_edges", "the number of values does not match the image size",
                "give width x height values");
  }
  int not_finite = 0;
  for (const float value : image.values) not_finite |= static_cast<int>(!std::isfinite(value));
  if (not_finite != 0) {
    throw Error("canny_edges", "a grey level is not finite", "use 0 to 255");
  }
  if (!(options.scale_px >= 0.5 && options.scale_px <= 20)) {
    throw Error("canny_edges", "the scale is not between 0.5 and 20 px", "use e.g. 1 px");
  }
  if (!(options.noise >= 0 && options.noise <= 255)) {
    throw Error("canny_edges", "the noise is not between 0 and 255 grey levels",
                "use 0 to estimate it from the image");
  }
  if (!(options.low > 0 && options.high >= options.low)) {
    throw Error("canny_edges", "the thresholds are not 0 < low <= high", "use e.g. 2 and 5");
  }
}

}  // namespace

std::vector<EdgePoint> canny_edges(const GreyLevels& image, const CannyOptions& options) {
  check(image, options);
  const GradientKernel kernel(options.scale_px);
  if (std::min(image.width_px, image.height_px) <= 2 * kernel.reach) return {};
  const cv::Mat grey = matrix_of(image);
  const double not_stated = std::numeric_limits<double>::quiet_NaN();
  const double noise = !options.with_sigma ? not_stated
                       : options.noise > 0 ? options.noise
                                           : image_noise(grey);
  const EdgePlaces places(kernel, noise);
  PeakFinder finder(grey.size(), options);
  GradientRows gradient;
  std::vector<EdgePoint> edges;
  edges.reserve(image.values.size() / 4);
  const int border = PeakFinder::border_px(options);
  for (int first = border; first < grey.rows - border; first += strip) {
    const int end = std::min(first + strip, grey.rows - border);
    gradient.compute(grey, kernel, first - 1, end + 2);
    const std::size_t before = edges.size();
    for (int y = first; y < end; ++y) finder.add_row(gradient, y, edges);
    places.place(gradient, std::span(edges).subspan(before));
  }
  keep_strings(finder.sets(), options, edges);
  return edges;
}

}  // namespace vernier::stereo
