// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/edges/edge_line.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calib/base/plane_vectors.h"
#include "stereo/canny_edges.h"

namespace vernier::stereo::internal {

void LineRegression::add(const Eigen::Vector2d& p) {
  sum_ += p;
  products_ += p * p.transpose();
  ++count_;
}

LineRegression LineRegression::since(const LineRegression& earlier) const {
  LineRegression rest;
  rest.sum_ = sum_ - earlier.sum_;
  rest.products_ = products_ - earlier.products_;
  rest.count_ = count_ - earlier.count_;
  return rest;
}

Eigen::Matrix2d LineRegression::scatter() const {
  return products_ - sum_ * sum_.transpose() / count_;
}

Eigen::Vector2d LineRegression::direction() const {
  const Eigen::Matrix2d s = scatter();
  const double angle = 0.5 * std::atan2(2 * s(0, 1), s(0, 0) - s(1, 1));
  return {std::cos(angle), std::sin(angle)};
}

double LineRegression::squares() const {  // the smaller eigenvalue
  const Eigen::Matrix2d s = scatter();
  return std::max(0.0, 0.5 * (s.trace() - std::hypot(s(0, 0) - s(1, 1), 2 * s(0, 1))));
}

double LineRegression::rms() const { return std::sqrt(squares() / std::max(1, count_ - 2)); }

EdgeLine::EdgeLine(const std::vector<EdgePoint>& points,
                   std::span<const int> places,
                   double scale_px) {
  const Eigen::Vector2d origin = points[places.front()].pixel_px.cast<double>();
  LineRegression regression;
  Eigen::Vector2d brighter(0, 0);
  for (const int i : places) {
    regression.add(points[i].pixel_px.cast<double>() - origin);
    brighter += points[i].normal.cast<double>();
  }
  centroid = origin + regression.centroid();
  direction = regression.direction();
  if (vernier::internal::cross(direction, brighter) < 0) direction = -direction;
  normal = {-direction.y(), direction.x()};
  rms_px = regression.rms();
  propagate(points, places, scale_px);
}

double EdgeLine::across_variance(double along_px) const {
  const Eigen::Vector2d h(1, along_px);
  return h.dot(covariance * h);
}

void EdgeLine::propagate(const std::vector<EdgePoint>& points,
                         std::span<const int> places,
                         double scale_px) {
  const std::size_t n = places.size();
  std::vector<double> s(n), sigma(n);
  double spread = 0, squares = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d p = points[places[i]].pixel_px.cast<double>();
    s[i] = along(p);
    sigma[i] = points[places[i]].sigma_px;
    spread += s[i] * s[i];
    squares += across(p) * across(p);
  }
  spacing_px = std::abs(s.back() - s.front()) / std::max<double>(1, static_cast<double>(n) - 1);
  const double range = 4 * (scale_px * scale_px + 2.0 / 3), reach = std::sqrt(7 * range);
  covariance.setZero();
  double expected = 0;  // of the squares: tr((I − P) C)
  const auto pair = [&](std::size_t i, std::size_t j) {
    const double apart = s[i] - s[j];
    const double c = sigma[i] * sigma[j] * std::exp(-apart * apart / range);
    const Eigen::Vector2d h_i(1.0 / static_cast<double>(n), s[i] / spread);
    const Eigen::Vector2d h_j(1.0 / static_cast<double>(n), s[j] / spread);
    const double projection = 1.0 / static_cast<double>(n) + s[i] * s[j] / spread;
    covariance += c * h_i * h_j.transpose();
    expected += ((i == j ? 1 : 0) - projection) * c;
  };
  for (std::size_t i = 0; i < n; ++i) {
    pair(i, i);
    for (std::size_t j = i + 1; j < n && std::abs(s[j] - s[i]) < reach; ++j) {
      pair(i, j);
      pair(j, i);
    }
  }
  noise_covariance = covariance;
  if (squares > expected && expected > 0) covariance *= squares / expected;
}

}  // namespace vernier::stereo::internal
