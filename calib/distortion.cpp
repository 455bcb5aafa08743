// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "calib/camera.h"

namespace vernier {
namespace {

/// x_d = x g with g a function of r²: the shared part of every radial model.
template <int N>
void scale_radially(const Eigen::Vector2d& x, double g, double g_by_r2, Distorted<N>& d) {
  d.x = x * g;
  d.by_x = Eigen::Matrix2d::Identity() * g + 2 * g_by_r2 * x * x.transpose();
}

/// Adds the decentring terms with p = (k[2], k[3]) and their derivatives.
template <int N>
void add_decentring(const Eigen::Vector2d& x, double p1, double p2, Distorted<N>& d) {
  const double xx = x[0] * x[0], xy = x[0] * x[1], yy = x[1] * x[1];
  d.by_k(0, 2) = 2 * xy;
  d.by_k(1, 2) = xx + 3 * yy;
  d.by_k(0, 3) = 3 * xx + yy;
  d.by_k(1, 3) = 2 * xy;
  d.x += d.by_k.col(2) * p1 + d.by_k.col(3) * p2;
  const double cross = 2 * (p1 * x[0] + p2 * x[1]);
  d.by_x(0, 0) += 2 * p1 * x[1] + 6 * p2 * x[0];
  d.by_x(0, 1) += cross;
  d.by_x(1, 0) += cross;
  d.by_x(1, 1) += 6 * p1 * x[1] + 2 * p2 * x[0];
}

}  // namespace

Distorted<0> Pinhole::distort(const Eigen::Vector2d& x, const double*) {
  return {x, Eigen::Matrix2d::Identity(), {}};
}

Distorted<1> Radial1::distort(const Eigen::Vector2d& x, const double* k) {
  Distorted<1> d;
  const double r2 = x.squaredNorm();
  scale_radially(x, 1 + k[0] * r2, k[0], d);
  d.by_k = x * r2;
  return d;
}

Distorted<4> OpenCv4::distort(const Eigen::Vector2d& x, const double* k) {
  Distorted<4> d;
  const double r2 = x.squaredNorm();
  scale_radially(x, 1 + r2 * (k[0] + r2 * k[1]), k[0] + 2 * r2 * k[1], d);
  d.by_k.col(0) = x * r2;
  d.by_k.col(1) = x * r2 * r2;
  add_decentring(x, k[2], k[3], d);
  return d;
}

Distorted<5> OpenCv5::distort(const Eigen::Vector2d& x, const double* k) {
  Distorted<5> d;
  const double r2 = x.squaredNorm();
  scale_radially(x, 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4])),
                 k[0] + r2 * (2 * k[1] + 3 * r2 * k[4]), d);
  d.by_k.col(0) = x * r2;
  d.by_k.col(1) = x * r2 * r2;
  d.by_k.col(4) = x * r2 * r2 * r2;
  add_decentring(x, k[2], k[3], d);
  return d;
}

Distorted<8> OpenCv8::distort(const Eigen::Vector2d& x, const double* k) {
  Distorted<8> d;
  const double r2 = x.squaredNorm(), r4 = r2 * r2, r6 = r4 * r2;
  const double top = 1 + k[0] * r2 + k[1] * r4 + k[4] * r6;
  const double bottom = 1 + k[5] * r2 + k[6] * r4 + k[7] * r6;
  const double g = top / bottom;
  const double top_by_r2 = k[0] + 2 * k[1] * r2 + 3 * k[4] * r4;
  const double bottom_by_r2 = k[5] + 2 * k[6] * r2 + 3 * k[7] * r4;
  scale_radially(x, g, (top_by_r2 - g * bottom_by_r2) / bottom, d);
  d.by_k.col(0) = x * (r2 / bottom);
  d.by_k.col(1) = x * (r4 / bottom);
  d.by_k.col(4) = x * (r6 / bottom);
  d.by_k.col(5) = x * (-g * r2 / bottom);
  d.by_k.col(6) = x * (-g * r4 / bottom);
  d.by_k.col(7) = x * (-g * r6 / bottom);
  add_decentring(x, k[2], k[3], d);
  return d;
}

Distorted<4> Fisheye4::distort(const Eigen::Vector2d& x, const double* k) {
  Distorted<4> d;
  const double r2 = x.squaredNorm(), r = std::sqrt(r2);
  if (r < 1e-8) {  // θ_d / r -> 1; its derivative by r² -> k1 - 1/3
    scale_radially(x, 1.0, k[0] - 1.0 / 3.0, d);
    d.by_k.setZero();
    return d;
  }
  const double t = std::atan(r), t2 = t * t;
  const double poly = 1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3])));
  const double poly_by_t = t * (2 * k[0] + t2 * (4 * k[1] + t2 * (6 * k[2] + t2 * 8 * k[3])));
  const double g = t * poly / r;
  const double theta_d_by_r = (poly + t * poly_by_t) / (1 + r2);
  const double g_by_r2 = (theta_d_by_r - g) / (2 * r2);
  scale_radially(x, g, g_by_r2, d);
  double power = t / r;
  for (int i = 0; i < 4; ++i) {
    power *= t2;
    d.by_k.col(i) = x * power;
  }
  return d;
}

}  // namespace vernier
