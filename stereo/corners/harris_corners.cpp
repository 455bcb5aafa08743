// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/corners/harris_corners.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "calib/projection_uncertainty.h"

namespace vernier::stereo::internal {
namespace {

/// The gradient filter: a sampled Gaussian, and its central difference.
struct GradientFilter {
  explicit GradientFilter(double scale_px) {
    const int radius = static_cast<int>(std::ceil(4 * scale_px));
    smooth = cv::getGaussianKernel(2 * radius + 1, scale_px, CV_32F);
    difference = cv::Mat::zeros(2 * radius + 3, 1, CV_32F);
    for (int i = 0; i <= 2 * radius; ++i) {
      difference.at<float>(i) -= smooth.at<float>(i) / 2;
      difference.at<float>(i + 2) += smooth.at<float>(i) / 2;
    }
  }
  void by_x(const cv::Mat& from, cv::Mat& to, int border = cv::BORDER_DEFAULT) const {
    cv::sepFilter2D(from, to, CV_32F, difference, smooth, {-1, -1}, 0, border);
  }
  void by_y(const cv::Mat& from, cv::Mat& to, int border = cv::BORDER_DEFAULT) const {
    cv::sepFilter2D(from, to, CV_32F, smooth, difference, {-1, -1}, 0, border);
  }
  int reach() const { return difference.rows / 2; }
  cv::Mat smooth, difference;
};

struct Gradients {
  cv::Mat x, y;
};

/// Windowed products of the gradient, and the Harris response.
struct StructureTensor {
  StructureTensor(const Gradients& g, const HarrisOptions& options) : k(options.k) {
    const int radius = static_cast<int>(std::ceil(4 * options.integration_scale_px));
    window = cv::getGaussianKernel(2 * radius + 1, options.integration_scale_px, CV_32F);
    const auto sum = [&](const cv::Mat& a, const cv::Mat& b) {
      cv::Mat product = a.mul(b), under_window;
      cv::sepFilter2D(product, under_window, CV_32F, window, window);
      return under_window;
    };
    xx = sum(g.x, g.x);
    yy = sum(g.y, g.y);
    xy = sum(g.x, g.y);
    const cv::Mat trace = xx + yy;
    response = xx.mul(yy) - xy.mul(xy) - k * trace.mul(trace);
  }
  double k;
  cv::Mat window, xx, yy, xy, response;
};

struct Peak {
  int x = 0, y = 0;
  double strength = 0;
};

/// Whether no neighbour is stronger; the first in reading order if tied. The nearest rows are
/// tested first, because most pixels fail there.
bool is_peak(const cv::Mat& r, int x, int y, int radius) {
  const float own = r.at<float>(y, x);
  for (int row = 0; row <= 2 * radius; ++row) {
    const int j = row % 2 == 0 ? row / 2 : -(row + 1) / 2;  // 0 −1 1 −2 2 …
    const float* at = r.ptr<float>(y + j) + x;
    for (int i = -radius; i <= radius; ++i) {
      const bool before = j < 0 || (j == 0 && i < 0);
      if (before ? at[i] >= own : at[i] > own) return false;
    }
  }
  return true;
}

std::vector<Peak> peaks(const cv::Mat& r, const HarrisOptions& options) {
  std::vector<Peak> found;
  const int border = std::max(options.border_px, options.suppression_radius_px);
  for (int y = border; y < r.rows - border; ++y) {
    const float* row = r.ptr<float>(y);
    for (int x = border; x < r.cols - border; ++x) {
      if (row[x] > 0 && is_peak(r, x, y, options.suppression_radius_px)) {
        found.push_back({x, y, row[x]});
      }
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Peak& a, const Peak& b) { return a.strength > b.strength; });
  return found;
}

/// Each cell's strongest first, up to its part of the count; then the rest.
std::vector<Peak> spread(const std::vector<Peak>& sorted,
                         cv::Size size,
                         const HarrisOptions& options) {
  if (options.cells <= 0 || options.count <= 0) return sorted;
  const int share = std::max(1, options.count / (options.cells * options.cells));
  std::map<int, int> taken;
  std::vector<Peak> first, rest;
  for (const Peak& peak : sorted) {
    const int column = peak.x * options.cells / size.width;
    const int row = peak.y * options.cells / size.height;
    (taken[row * options.cells + column]++ < share ? first : rest).push_back(peak);
  }
  first.insert(first.end(), rest.begin(), rest.end());
  return first;
}

/// Peak of the parabola through three values, relative to the middle one, and its derivatives.
struct Vertex {
  Vertex(double before, double at, double after) {
    const double bend = before - 2 * at + after;
    if (!(bend < 0)) return;
    const double unclamped = 0.5 * (before - after) / bend;
    if (std::abs(unclamped) > 0.5) return;
    offset = unclamped;
    by_values[0] = (0.5 - offset) / bend;
    by_values[1] = 2 * offset / bend;
    by_values[2] = (-0.5 - offset) / bend;
  }
  double offset = 0, by_values[3] = {0, 0, 0};
};

/// Förstner's point around a peak of the response.
class PointFit {
 public:
  PointFit(const Gradients& g,
           const StructureTensor& tensor,
           const Peak& peak,
           const HarrisOptions& options)
      : gradients_(g),
        tensor_(tensor),
        peak_(peak),
        scale_(options.integration_scale_px),
        half_(tensor.window.rows / 2 + 1),
        vertex_{vertex(1, 0), vertex(0, 1)},
        centre_(peak.x + vertex_[0].offset, peak.y + vertex_[1].offset) {
    for (int axis = 0; axis < 2; ++axis) {
      for (int i = -half_; i <= half_; ++i) {
        const double from_centre = i - vertex_[axis].offset;
        weights_[axis].push_back(std::exp(-from_centre * from_centre / (2 * scale_ * scale_)));
      }
    }
  }

  std::optional<Eigen::Vector2d> point(double max_shift_px) {
    Eigen::Matrix2d M = Eigen::Matrix2d::Zero();
    Eigen::Vector2d b = Eigen::Vector2d::Zero();
    for_window([&](int i, int j, const Eigen::Vector2d& from_centre, const Eigen::Vector2d& g) {
      const double w = weight(i, j);
      M += w * g * g.transpose();
      b += w * g * g.dot(from_centre);
    });
    if (!(M.determinant() > 1e-9 * M.trace() * M.trace())) return std::nullopt;
    inverse_ = M.inverse();
    shift_ = inverse_ * b;
    if (!(shift_.norm() <= max_shift_px)) return std::nullopt;
    return centre_ + shift_;
  }

  /// σ² Σ_q c_q c_qᵀ with c_q = ∂p / ∂I_q: derivatives by the gradients, passed through the
  /// gradient filter again.
  Eigen::Matrix2d covariance(const GradientFilter& filter, double noise) const {
    if (noise == 0) return Eigen::Matrix2d::Zero();
    const int margin = filter.reach(), size = 2 * (half_ + margin) + 1;
    cv::Mat by_gx[2], by_gy[2];
    for (int a = 0; a < 2; ++a) {
      by_gx[a] = cv::Mat::zeros(size, size, CV_32F);
      by_gy[a] = cv::Mat::zeros(size, size, CV_32F);
    }
    const Eigen::Matrix2d by_centre = point_by_centre();
    const ResponseSlopes slopes = response_slopes();
    for_window([&](int i, int j, const Eigen::Vector2d& from_centre, const Eigen::Vector2d& g) {
      const Eigen::Vector2d to = from_centre - shift_;
      const Eigen::Matrix2d at_fixed_centre =
          weight(i, j) * inverse_ * (g * to.transpose() + g.dot(to) * Eigen::Matrix2d::Identity());
      const Eigen::Matrix2d by_g =
          at_fixed_centre + by_centre * centre_by_gradient(slopes, i, j, g);
      for (int a = 0; a < 2; ++a) {
        by_gx[a].at<float>(j + half_ + margin, i + half_ + margin) = static_cast<float>(by_g(a, 0));
        by_gy[a].at<float>(j + half_ + margin, i + half_ + margin) = static_cast<float>(by_g(a, 1));
      }
    });
    cv::Mat c[2];
    for (int a = 0; a < 2; ++a) {
      cv::Mat x, y;
      filter.by_x(by_gx[a], x, cv::BORDER_CONSTANT);
      filter.by_y(by_gy[a], y, cv::BORDER_CONSTANT);
      c[a] = x + y;
    }
    Eigen::Matrix2d sum;
    sum << c[0].dot(c[0]), c[0].dot(c[1]), c[0].dot(c[1]), c[1].dot(c[1]);
    return noise * noise * sum;
  }

 private:
  Vertex vertex(int dx, int dy) const {
    const cv::Mat& r = tensor_.response;
    return {r.at<float>(peak_.y - dy, peak_.x - dx), r.at<float>(peak_.y, peak_.x),
            r.at<float>(peak_.y + dy, peak_.x + dx)};
  }

  /// Of the window around its centre, at the peak's pixel plus (i, j): a product of two factors.
  double weight(int i, int j) const { return weights_[0][i + half_] * weights_[1][j + half_]; }

  /// ∂p / ∂c of the window's centre c: M⁻¹ Σ (w / s²) g gᵀ (x − p) (x − c)ᵀ.
  Eigen::Matrix2d point_by_centre() const {
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    for_window([&](int i, int j, const Eigen::Vector2d& from_centre, const Eigen::Vector2d& g) {
      sum += weight(i, j) / (scale_ * scale_) * g.dot(from_centre - shift_) * g *
             from_centre.transpose();
    });
    return inverse_ * sum;
  }

  /// ∂c / ∂R times ∂R / ∂g = w (S g)ᵀ of the three responses R in a row or column that enter a
  /// parabola; with ∂R = (yy − 2k tr) ∂xx + (xx − 2k tr) ∂yy − 2 xy ∂xy.
  using ResponseSlopes = std::array<std::array<Eigen::Matrix2d, 3>, 2>;
  ResponseSlopes response_slopes() const {
    ResponseSlopes slopes;
    for (int axis = 0; axis < 2; ++axis) {
      for (int step = -1; step <= 1; ++step) {
        const int x = peak_.x + (axis == 0 ? step : 0), y = peak_.y + (axis == 0 ? 0 : step);
        const double xx = tensor_.xx.at<float>(y, x), yy = tensor_.yy.at<float>(y, x);
        const double xy = tensor_.xy.at<float>(y, x), edge = 2 * tensor_.k * (xx + yy);
        slopes[axis][step + 1] << yy - edge, -xy, -xy, xx - edge;
        slopes[axis][step + 1] *= 2 * vertex_[axis].by_values[step + 1];
      }
    }
    return slopes;
  }

  /// ∂c / ∂g of the gradient at the peak's pixel plus (i, j).
  Eigen::Matrix2d centre_by_gradient(const ResponseSlopes& slopes,
                                     int i,
                                     int j,
                                     const Eigen::Vector2d& g) const {
    const double at_i = window_at(i), at_j = window_at(j);
    Eigen::Matrix2d by_gradient;
    by_gradient.row(0) =
        ((window_at(i + 1) * at_j) * (slopes[0][0] * g) + (at_i * at_j) * (slopes[0][1] * g) +
         (window_at(i - 1) * at_j) * (slopes[0][2] * g))
            .transpose();
    by_gradient.row(1) =
        ((at_i * window_at(j + 1)) * (slopes[1][0] * g) + (at_i * at_j) * (slopes[1][1] * g) +
         (at_i * window_at(j - 1)) * (slopes[1][2] * g))
            .transpose();
    return by_gradient;
  }

  double window_at(int i) const {
    const int at = i + tensor_.window.rows / 2;
    return at < 0 || at >= tensor_.window.rows ? 0 : tensor_.window.at<float>(at);
  }

  /// visit(i, j, pixel minus window centre, gradient), i and j relative to the peak's pixel.
  template <class Visit>
  void for_window(Visit visit) const {
    for (int j = -half_; j <= half_; ++j) {
      const int y = peak_.y + j;
      if (y < 0 || y >= gradients_.x.rows) continue;
      for (int i = -half_; i <= half_; ++i) {
        const int x = peak_.x + i;
        if (x < 0 || x >= gradients_.x.cols) continue;
        visit(i, j, Eigen::Vector2d(x, y) - centre_,
              Eigen::Vector2d(gradients_.x.at<float>(y, x), gradients_.y.at<float>(y, x)));
      }
    }
  }

  const Gradients& gradients_;
  const StructureTensor& tensor_;
  Peak peak_;
  double scale_;
  int half_;
  Vertex vertex_[2];
  std::vector<double> weights_[2];  ///< of columns and rows of the window
  Eigen::Vector2d centre_, shift_;  ///< of the window, and from it to the point
  Eigen::Matrix2d inverse_;         ///< M⁻¹
};

/// Two peaks may have the same refined point.
bool is_new(const std::vector<ImageCorner>& corners, const Eigen::Vector2d& point) {
  return std::none_of(corners.begin(), corners.end(), [&](const ImageCorner& corner) {
    return (corner.pixel_px - point).squaredNorm() < 1;
  });
}

}  // namespace

std::vector<ImageCorner> harris_corners(const cv::Mat& grey,
                                        double noise,
                                        const HarrisOptions& options) {
  const GradientFilter filter(options.gradient_scale_px);
  Gradients g;
  filter.by_x(grey, g.x);
  filter.by_y(grey, g.y);
  const StructureTensor tensor(g, options);
  std::vector<ImageCorner> corners;
  for (const Peak& peak : spread(peaks(tensor.response, options), grey.size(), options)) {
    if (options.count > 0 && corners.size() >= static_cast<std::size_t>(options.count)) break;
    PointFit fit(g, tensor, peak, options);
    const auto point = fit.point(options.max_shift_px);
    if (!point || !is_new(corners, *point)) continue;
    const Eigen::Matrix2d covariance = fit.covariance(filter, noise);
    if (!(worst_sd(covariance) <= options.worst_sigma_px)) continue;
    corners.push_back({*point, covariance, peak.strength});
  }
  std::stable_sort(corners.begin(), corners.end(), [](const ImageCorner& a, const ImageCorner& b) {
    return a.strength > b.strength;
  });
  return corners;
}

}  // namespace vernier::stereo::internal
