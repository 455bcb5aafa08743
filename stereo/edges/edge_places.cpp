// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/edges/edge_places.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/core/hal/hal.hpp>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/image/image_gradient.h"

namespace vernier::stereo::internal {
namespace {

constexpr float min_ratio = 0.1F;  // minimum ratio of a neighbour's gradient to the peak's
// Minimum curvature of log |g|: that of a step blurred by 14 px.
constexpr float min_curvature = 0.005F;
constexpr float max_offset = 0.75F;  // in pixels along the nearer axis

/// Σ_u a(u) b(u + shift)
double correlation(const std::vector<double>& a, const std::vector<double>& b, int shift) {
  const int size = static_cast<int>(a.size());
  double sum = 0;
  for (int u = std::max(0, -shift); u < std::min(size, size - shift); ++u) {
    sum += a[u] * b[u + shift];
  }
  return sum;
}

}  // namespace

/// One number per point.
struct EdgePlaces::Batch {
  Lanes nx, ny;                 ///< normal
  Lanes strength;               ///< |g| at the pixel
  std::array<Lanes, 9> ratio;   ///< |g_i| relative to that of the pixel
  std::array<Lanes, 9> by_log;  ///< ∂t / ∂log |g_i|
  Lanes offset, standard_deviation;
};

EdgePlaces::EdgePlaces(const GradientKernel& kernel, double noise)
    : noise_(static_cast<float>(noise)), correlation_{} {
  const auto& g = kernel.smooth;
  const auto& d = kernel.slope;
  for (int dy = 0; dy <= 2; ++dy) {
    for (int dx = dy == 0 ? 0 : -2; dx <= 2; ++dx) {
      const double both = dx == 0 && dy == 0 ? 1 : 2;
      const double xx = correlation(d, d, dx) * correlation(g, g, dy);
      const double xy = correlation(d, g, dx) * correlation(g, d, dy) +
                        correlation(g, d, dx) * correlation(d, g, dy);
      const double yy = correlation(g, g, dx) * correlation(d, d, dy);
      correlation_[dy * 5 + dx + 2] = {static_cast<float>(both * xx), static_cast<float>(both * xy),
                                       static_cast<float>(both * yy)};
    }
  }
}

void EdgePlaces::gather(const GradientRows& gradient,
                        std::span<const EdgePoint> points,
                        Batch& batch) {
  for (std::size_t k = 0; k < lanes; ++k) {
    const EdgePoint& point = points[std::min(k, points.size() - 1)];
    const int row = point.y - gradient.first_row;
    for (int j = 0; j < 3; ++j) {
      const float* from = gradient.strength.ptr<float>(row + j - 1) + point.x - 1;
      for (int i = 0; i < 3; ++i) batch.ratio[3 * j + i][k] = from[i];
    }
    batch.nx[k] = gradient.x.ptr<float>(row)[point.x];
    batch.ny[k] = gradient.y.ptr<float>(row)[point.x];
  }
  batch.strength = batch.ratio[4];
  for (int k = 0; k < lanes; ++k) {
    batch.nx[k] /= batch.strength[k];
    batch.ny[k] /= batch.strength[k];
  }
  for (Lanes& ratio : batch.ratio) {
    for (int k = 0; k < lanes; ++k) ratio[k] = std::max(min_ratio, ratio[k] / batch.strength[k]);
  }
}

/// t = −nᵀb / (2 nᵀC n) by least squares, and its derivatives.
void EdgePlaces::fit(Batch& batch) {
  std::array<Lanes, 9> log, by_slope, by_bend;
  cv::hal::log32f(batch.ratio[0].data(), log[0].data(), 9 * lanes);
  Lanes slope{}, bend{};
  for (int i = 0; i < 9; ++i) {
    const int column = i % 3 - 1, row = i / 3 - 1;
    const auto x = static_cast<float>(column), y = static_cast<float>(row);
    for (int k = 0; k < lanes; ++k) {
      const float nx = batch.nx[k], ny = batch.ny[k];
      by_slope[i][k] = (nx * x + ny * y) * (1.F / 6);
      by_bend[i][k] =
          nx * nx * (x * x - 2.F / 3) + ny * ny * (y * y - 2.F / 3) + nx * ny * (x * y / 2);
      slope[k] += by_slope[i][k] * log[i][k];
      bend[k] += by_bend[i][k] * log[i][k];
    }
  }
  for (int k = 0; k < lanes; ++k) {
    const float most = max_offset / std::max(std::abs(batch.nx[k]), std::abs(batch.ny[k]));
    bend[k] = -1 / std::min(bend[k], -min_curvature);
    batch.offset[k] = std::min(most, std::max(-most, slope[k] * bend[k]));
  }
  for (int i = 0; i < 9; ++i) {
    for (int k = 0; k < lanes; ++k) {
      batch.by_log[i][k] = (by_slope[i][k] + batch.offset[k] * by_bend[i][k]) * bend[k];
    }
  }
}

/// var t = σ² Σ_ij q_i q_j nᵀ R(i − j) n with q_i = ∂t / ∂log |g_i| / |g_i|.
void EdgePlaces::propagate(Batch& batch) const {
  if (std::isnan(noise_)) {
    batch.standard_deviation.fill(noise_);
    return;
  }
  std::array<Lanes, 9> q;
  Lanes variance{};
  for (int i = 0; i < 9; ++i) {
    for (int k = 0; k < lanes; ++k) {
      q[i][k] = batch.by_log[i][k] / (batch.ratio[i][k] * batch.strength[k]);
    }
  }
  for (int dy = 0; dy <= 2; ++dy) {
    for (int dx = dy == 0 ? 0 : -2; dx <= 2; ++dx) {
      const auto [xx, xy, yy] = correlation_[dy * 5 + dx + 2];
      Lanes products{};
      for (int y = 0; y + dy < 3; ++y) {
        for (int x = std::max(0, -dx); x < std::min(3, 3 - dx); ++x) {
          const Lanes& one = q[y * 3 + x];
          const Lanes& other = q[(y + dy) * 3 + x + dx];
          for (int k = 0; k < lanes; ++k) products[k] += one[k] * other[k];
        }
      }
      for (int k = 0; k < lanes; ++k) {
        const float nx = batch.nx[k], ny = batch.ny[k];
        variance[k] += products[k] * (nx * nx * xx + nx * ny * xy + ny * ny * yy);
      }
    }
  }
  for (int k = 0; k < lanes; ++k) {
    batch.standard_deviation[k] = noise_ * std::sqrt(std::max(variance[k], 0.F));
  }
}

void EdgePlaces::place(const GradientRows& gradient, std::span<EdgePoint> points) const {
  Batch batch;
  for (; !points.empty(); points = points.subspan(std::min<std::size_t>(lanes, points.size()))) {
    gather(gradient, points, batch);
    fit(batch);
    propagate(batch);
    for (std::size_t k = 0; k < std::min<std::size_t>(lanes, points.size()); ++k) {
      EdgePoint& point = points[k];
      point.normal = {batch.nx[k], batch.ny[k]};
      point.pixel_px = Eigen::Vector2f(point.x, point.y) + batch.offset[k] * point.normal;
      const float along_row = batch.nx[k] == 0 ? 0 : batch.offset[k] / batch.nx[k];
      point.row_x_px = static_cast<float>(point.x) + std::clamp(along_row, -1.5F, 1.5F);
      point.strength = batch.strength[k];
      point.sigma_px = batch.standard_deviation[k];
    }
  }
}

}  // namespace vernier::stereo::internal
