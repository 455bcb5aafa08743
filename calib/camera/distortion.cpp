// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "calib/lens_models.h"

namespace vernier {
namespace {

using std::atan;
using std::sqrt;

double mul_add(double a, double b, double c) { return a * b + c; }

double at_least(double a, double b) { return a < b ? b : a; }

#include "calib/camera/corner_formulas.inc"

template <class Model>
auto distorted_point(Model model, const Eigen::Vector2d& x, const double* k) {
  constexpr int n = static_cast<int>(Model::distortion_names.size());
  const auto d = distorted(model, x[0], x[1], k);
  Distorted<n> result;
  result.x = {d.x, d.y};
  result.by_x << d.x_by_x, d.x_by_y, d.x_by_y, d.y_by_y;
  for (int i = 0; i < n; ++i) result.by_k.col(i) << d.x_by_k[i], d.y_by_k[i];
  return result;
}

}  // namespace

Distorted<0> Pinhole::distort(const Eigen::Vector2d& x, const double* k) {
  return distorted_point(Pinhole{}, x, k);
}

Distorted<1> Radial1::distort(const Eigen::Vector2d& x, const double* k) {
  return distorted_point(Radial1{}, x, k);
}

Distorted<4> OpenCv4::distort(const Eigen::Vector2d& x, const double* k) {
  return distorted_point(OpenCv4{}, x, k);
}

Distorted<5> OpenCv5::distort(const Eigen::Vector2d& x, const double* k) {
  return distorted_point(OpenCv5{}, x, k);
}

Distorted<8> OpenCv8::distort(const Eigen::Vector2d& x, const double* k) {
  return distorted_point(OpenCv8{}, x, k);
}

Distorted<4> Fisheye4::distort(const Eigen::Vector2d& x, const double* k) {
  return distorted_point(Fisheye4{}, x, k);
}

}  // namespace vernier
