// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/canny_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "calib/error.h"
#include "stereo/image_noise.h"

namespace vernier {
namespace {

constexpr double reach_scales = 3.5;       // a Gaussian is cut off here
constexpr float least_ratio = 0.1F;        // of a neighbour's gradient to the peak's
constexpr float least_curvature = 0.005F;  // of log |g|, that of a step blurred by 10 px

/// A sampled Gaussian of sum one and its derivative, of unit response to a ramp.
struct GradientFilter {
  explicit GradientFilter(double scale_px)
      : reach(static_cast<int>(reach_scales * scale_px + 0.5)) {
    double sum = 0, moment = 0;
    for (int i = -reach; i <= reach; ++i) {
      const double g = std::exp(-i * i / (2 * scale_px * scale_px));
      smooth.push_back(g);
      slope.push_back(i * g);
      sum += g;
      moment += i * i * g;
    }
    for (double& value : smooth) value /= sum;
    for (double& value : slope) value /= moment;
  }
  int reach;
  std::vector<double> smooth, slope;
};

/// Σ_u a(u) b(u + shift)
double correlation(const std::vector<double>& a, const std::vector<double>& b, int shift) {
  const int size = static_cast<int>(a.size());
  double sum = 0;
  for (int u = std::max(0, -shift); u < std::min(size, size - shift); ++u)
    sum += a[u] * b[u + shift];
  return sum;
}

/// Variance of Σ_i q_i nᵀ δg_i over 3 x 3 pixels, for image noise of one grey level.
class NoisePropagation {
 public:
  explicit NoisePropagation(const GradientFilter& filter) {
    for (int dy = 0; dy <= 2; ++dy) {
      for (int dx = -2; dx <= 2; ++dx) {
        const auto& g = filter.smooth;
        const auto& d = filter.slope;
        const double twice = dx == 0 && dy == 0 ? 1 : 2;  // r and −r
        const double xx = correlation(d, d, dx) * correlation(g, g, dy);
        const double yy = correlation(g, g, dx) * correlation(d, d, dy);
        const double xy = correlation(d, g, dx) * correlation(g, d, dy) +
                          correlation(g, d, dx) * correlation(d, g, dy);
        by_shift_[dy * 5 + dx + 2] = {static_cast<float>(twice * xx),
                                      static_cast<float>(twice * xy),
                                      static_cast<float>(twice * yy)};
      }
    }
  }

  float variance(const std::array<float, 9>& q, const Eigen::Vector2f& n) const {
    float sum = 0;
    for (int dy = 0; dy <= 2; ++dy) {
      for (int dx = dy == 0 ? 0 : -2; dx <= 2; ++dx) {
        const auto& by = by_shift_[dy * 5 + dx + 2];
        float products = 0;
        for (int y = 0; y + dy < 3; ++y) {
          for (int x = std::max(0, -dx); x < std::min(3, 3 - dx); ++x) {
            products += q[y * 3 + x] * q[(y + dy) * 3 + x + dx];
          }
        }
        sum += products * (n.x() * n.x() * by[0] + n.x() * n.y() * by[1] + n.y() * n.y() * by[2]);
      }
    }
    return std::max(sum, 0.F);
  }

 private:
  std::array<std::array<float, 3>, 15> by_shift_;  // of xx, xy + yx, yy
};

struct Gradients {
  Gradients(const cv::Mat& grey, const GradientFilter& filter) {
    cv::sepFilter2D(grey, x, CV_32F, filter.slope, filter.smooth, {-1, -1}, 0,
                    cv::BORDER_REPLICATE);
    cv::sepFilter2D(grey, y, CV_32F, filter.smooth, filter.slope, {-1, -1}, 0,
                    cv::BORDER_REPLICATE);
    squared = x.mul(x) + y.mul(y);
  }
  cv::Mat x, y, squared;
};

/// Whether |g|² is the largest along g, by interpolation between the pixels one row (or column,
/// whichever g is steeper to) away on either side.
bool is_peak(const Gradients& g, int x, int y) {
  const float gx = g.x.at<float>(y, x), gy = g.y.at<float>(y, x);
  const auto step = static_cast<std::ptrdiff_t>(g.squared.step1());
  const float* at = g.squared.ptr<float>(y) + x;
  const bool along_row = std::abs(gx) >= std::abs(gy);
  const std::ptrdiff_t major = along_row ? 1 : step;
  const std::ptrdiff_t minor =
      (gx > 0) == (gy > 0) ? (along_row ? step : 1) : -(along_row ? step : 1);
  const float part = along_row ? std::abs(gy / gx) : std::abs(gx / gy);
  const float ahead = (1 - part) * at[major] + part * at[major + minor];
  const float behind = (1 - part) * at[-major] + part * at[-major - minor];
  return *at > ahead && *at >= behind;
}

struct Candidate {
  int x, y;
  bool strong;
};

/// Sets of connected candidates.
class Strings {
 public:
  int add() {
    parents_.push_back(static_cast<int>(parents_.size()));
    return parents_.back();
  }
  int root(int i) {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
    return i;
  }
  void join(int a, int b) {  // the first in reading order is the root
    a = root(a);
    b = root(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<int> parents_;
};

/// Peaks above `low`, each with the number of its string.
std::vector<Candidate> find_peaks(const Gradients& g,
                                  const CannyOptions& options,
                                  Strings& strings) {
  const auto low = static_cast<float>(options.low * options.low);
  const auto high = static_cast<float>(options.high * options.high);
  const int border = std::max(1, static_cast<int>(std::ceil(2 * options.scale_px)));
  std::vector<Candidate> peaks;
  std::vector<int> above(g.squared.cols, -1), own(g.squared.cols, -1);
  for (int y = border; y < g.squared.rows - border; ++y) {
    const float* row = g.squared.ptr<float>(y);
    std::fill(own.begin(), own.end(), -1);
    for (int x = border; x < g.squared.cols - border; ++x) {
      if (row[x] < low || !is_peak(g, x, y)) continue;
      own[x] = strings.add();
      for (const int other : {own[x - 1], above[x - 1], above[x], above[x + 1]}) {
        if (other >= 0) strings.join(own[x], other);
      }
      peaks.push_back({x, y, row[x] >= high});
    }
    std::swap(above, own);
  }
  return peaks;
}

/// Numbers of the strings that stay, −1 for the others; in the order of their first points.
std::vector<int> number_strings(const std::vector<Candidate>& peaks,
                                Strings& strings,
                                int least_points) {
  std::vector<int> points(peaks.size(), 0), number(peaks.size(), -1);
  std::vector<char> strong(peaks.size(), 0);
  for (std::size_t i = 0; i < peaks.size(); ++i) {
    const int root = strings.root(static_cast<int>(i));
    ++points[root];
    strong[root] |= static_cast<char>(peaks[i].strong);
  }
  int next = 0;
  for (std::size_t i = 0; i < peaks.size(); ++i) {
    const int root = strings.root(static_cast<int>(i));
    if (!strong[root] || points[root] < least_points) continue;
    if (number[root] < 0) number[root] = next++;
    number[i] = number[root];
  }
  return number;
}

/// The quadratic about a pixel.
class Localisation {
 public:
  Localisation(const Gradients& g, const GradientFilter& filter, double noise)
      : g_(g), propagation_(filter), noise_(static_cast<float>(noise)) {}

  EdgePoint operator()(const Candidate& peak, int string) const {
    const float gx = g_.x.at<float>(peak.y, peak.x), gy = g_.y.at<float>(peak.y, peak.x);
    const float squared = g_.squared.at<float>(peak.y, peak.x), strength = std::sqrt(squared);
    const Eigen::Vector2f n(gx / strength, gy / strength);
    std::array<float, 9> squares{};
    for (int j = 0; j < 3; ++j) {
      const float* row = g_.squared.ptr<float>(peak.y + j - 1) + peak.x - 1;
      for (int i = 0; i < 3; ++i) {
        squares[3 * j + i] = std::max(row[i], least_ratio * least_ratio * squared);
      }
    }
    EdgePoint point{peak.x, peak.y};
    std::array<float, 9> by_pixel{};
    const float t = offset(squares, n, by_pixel);
    for (int i = 0; i < 9; ++i) by_pixel[i] /= std::sqrt(squares[i]);
    point.pixel_px = Eigen::Vector2f(peak.x, peak.y) + t * n;
    const float along_row = n.x() == 0 ? 0 : t / n.x();
    point.row_x_px = static_cast<float>(peak.x) + std::clamp(along_row, -1.5F, 1.5F);
    point.normal = n;
    point.strength = strength;
    point.sigma_px = noise_ * std::sqrt(propagation_.variance(by_pixel, n));
    point.string = string;
    return point;
  }

 private:
  /// t, and its derivatives by log |g_i|.
  static float offset(const std::array<float, 9>& squares,
                      const Eigen::Vector2f& n,
                      std::array<float, 9>& by_log) {
    std::array<float, 9> by_slope{}, by_bend{};
    float slope = 0, bend = 0;
    for (int k = 0; k < 9; ++k) {
      const auto x = static_cast<float>(k % 3 - 1), y = static_cast<float>(k / 3 - 1);
      by_slope[k] = (n.x() * x + n.y() * y) / 6;
      by_bend[k] = n.x() * n.x() * (x * x - 2.F / 3) + n.y() * n.y() * (y * y - 2.F / 3) +
                   n.x() * n.y() * x * y / 2;
      const float value = std::log(squares[k]) / 2;
      slope += by_slope[k] * value;
      bend += by_bend[k] * value;  // 2 nᵀ C n
    }
    bend = std::min(bend, -least_curvature);
    const float most = 0.75F / std::max(std::abs(n.x()), std::abs(n.y()));
    const float t = std::clamp(-slope / bend, -most, most);
    for (int k = 0; k < 9; ++k) by_log[k] = -(by_slope[k] + t * by_bend[k]) / bend;
    return t;
  }

  const Gradients& g_;
  NoisePropagation propagation_;
  float noise_;
};

void check(const GreyLevels& image, const CannyOptions& options) {
  if (image.width_px < 0 || image.height_px < 0 ||
      image.values.size() != static_cast<std::size_t>(image.width_px) *
                                 static_cast<std::size_t>(std::max(0, image.height_px))) {
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
  const GradientFilter filter(options.scale_px);
  if (std::min(image.width_px, image.height_px) <= 2 * filter.reach) return {};
  const cv::Mat grey(image.height_px, image.width_px, CV_32F,
                     const_cast<float*>(image.values.data()));
  const Gradients gradients(grey, filter);
  Strings strings;
  const std::vector<Candidate> peaks = find_peaks(gradients, options, strings);
  const std::vector<int> numbers = number_strings(peaks, strings, options.least_points);
  const Localisation localise(gradients, filter, image_noise(grey));
  std::vector<EdgePoint> edges;
  for (std::size_t i = 0; i < peaks.size(); ++i) {
    if (numbers[i] >= 0) edges.push_back(localise(peaks[i], numbers[i]));
  }
  return edges;
}

}  // namespace vernier
