// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/harris_corners.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "calib/projection_uncertainty.h"

namespace vernier {
namespace {

/// The gradient's filter: a sampled Gaussian, and its central difference.
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

struct Peak {
  int x = 0, y = 0;
  double strength = 0;
};

cv::Mat response(const Gradients& g, const HarrisOptions& options) {
  const double s = options.integration_scale_px;
  const auto window = [&](const cv::Mat& a, const cv::Mat& b) {
    cv::Mat product = a.mul(b), sum;
    cv::GaussianBlur(product, sum, {0, 0}, s);
    return sum;
  };
  const cv::Mat xx = window(g.x, g.x), yy = window(g.y, g.y), xy = window(g.x, g.y);
  const cv::Mat trace = xx + yy;
  return xx.mul(yy) - xy.mul(xy) - options.k * trace.mul(trace);
}

/// Whether no neighbour is stronger; of equal ones the first in reading order is the peak.
bool is_peak(const cv::Mat& r, int x, int y, int radius) {
  const float own = r.at<float>(y, x);
  for (int j = -radius; j <= radius; ++j) {
    const float* row = r.ptr<float>(y + j);
    for (int i = -radius; i <= radius; ++i) {
      const bool before = j < 0 || (j == 0 && i < 0);
      if (before ? row[x + i] >= own : row[x + i] > own) return false;
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

/// Every part's strongest first, up to its share of the count; then the rest.
std::vector<Peak> spread(std::vector<Peak> sorted, cv::Size size, const HarrisOptions& options) {
  if (options.cells <= 0 || options.count <= 0) return sorted;
  const int share = std::max(1, options.count / (options.cells * options.cells));
  std::map<int, int> taken;
  std::stable_partition(sorted.begin(), sorted.end(), [&](const Peak& peak) {
    const int column = peak.x * options.cells / size.width;
    const int row = peak.y * options.cells / size.height;
    return taken[row * options.cells + column]++ < share;
  });
  return sorted;
}

/// Quadratic peak of three values about the middle one.
double vertex(double before, double at, double after) {
  const double bend = before - 2 * at + after;
  return bend < 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0;
}

/// Förstner's point and the window it comes from.
class PointFit {
 public:
  PointFit(const Gradients& g, const cv::Mat& r, const Peak& peak, const HarrisOptions& options)
      : gradients_(g),
        peak_(peak),
        scale_(options.integration_scale_px),
        half_(static_cast<int>(std::ceil(3 * options.integration_scale_px))),
        centre_(peak.x + vertex(r.at<float>(peak.y, peak.x - 1),
                                r.at<float>(peak.y, peak.x),
                                r.at<float>(peak.y, peak.x + 1)),
                peak.y + vertex(r.at<float>(peak.y - 1, peak.x),
                                r.at<float>(peak.y, peak.x),
                                r.at<float>(peak.y + 1, peak.x))) {}

  std::optional<Eigen::Vector2d> point(double most_shift_px) {
    Eigen::Matrix2d M = Eigen::Matrix2d::Zero();
    Eigen::Vector2d b = Eigen::Vector2d::Zero();
    for_window([&](int, int, const Eigen::Vector2d& x, const Eigen::Vector2d& g, double w) {
      M += w * g * g.transpose();
      b += w * g * g.dot(x - centre_);
    });
    if (!(M.determinant() > 1e-9 * M.trace() * M.trace())) return std::nullopt;
    inverse_ = M.inverse();
    point_ = centre_ + inverse_ * b;
    if (!((point_ - centre_).norm() <= most_shift_px)) return std::nullopt;
    return point_;
  }

  /// σ² M⁻¹ (Σ_q c_q c_qᵀ) M⁻¹ with c_q = ∂(Σ w g gᵀ (x − p)) / ∂I_q: the gradient's filter again.
  Eigen::Matrix2d covariance(const GradientFilter& filter, double noise) const {
    const int margin = filter.reach(), size = 2 * (half_ + margin) + 1;
    cv::Mat by_gx[2], by_gy[2];
    for (int a = 0; a < 2; ++a) {
      by_gx[a] = cv::Mat::zeros(size, size, CV_32F);
      by_gy[a] = cv::Mat::zeros(size, size, CV_32F);
    }
    for_window([&](int i, int j, const Eigen::Vector2d& x, const Eigen::Vector2d& g, double w) {
      const Eigen::Vector2d to = x - point_;
      const Eigen::Matrix2d by_g =
          w * (g * to.transpose() + g.dot(to) * Eigen::Matrix2d::Identity());
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
    return noise * noise * inverse_ * sum * inverse_;
  }

 private:
  /// visit(i, j, pixel, gradient, weight)
  template <class Visit>
  void for_window(Visit visit) const {
    for (int j = -half_; j <= half_; ++j) {
      const int y = peak_.y + j;
      if (y < 0 || y >= gradients_.x.rows) continue;
      for (int i = -half_; i <= half_; ++i) {
        const int x = peak_.x + i;
        if (x < 0 || x >= gradients_.x.cols) continue;
        const Eigen::Vector2d pixel(x, y);
        const double r2 = (pixel - centre_).squaredNorm();
        const Eigen::Vector2d g(gradients_.x.at<float>(y, x), gradients_.y.at<float>(y, x));
        visit(i, j, pixel, g, std::exp(-r2 / (2 * scale_ * scale_)));
      }
    }
  }

  const Gradients& gradients_;
  Peak peak_;
  double scale_;
  int half_;
  Eigen::Vector2d centre_, point_;
  Eigen::Matrix2d inverse_;
};

/// Two peaks may have one point.
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
  const cv::Mat r = response(g, options);
  std::vector<ImageCorner> corners;
  for (const Peak& peak : spread(peaks(r, options), grey.size(), options)) {
    if (options.count > 0 && corners.size() >= static_cast<std::size_t>(options.count)) break;
    PointFit fit(g, r, peak, options);
    const auto point = fit.point(options.most_shift_px);
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

}  // namespace vernier
