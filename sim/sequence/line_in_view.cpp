// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/sequence/line_in_view.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calib/pose.h"
#include "stereo/image/depth_image.h"

namespace vernier::sim::internal {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double nearest_m = 0.1;
constexpr int beside_px = 4;

/// Keeps the part of t in [low, high] where the linear function from `at_a` to `at_b` is above 0.
void clip(double at_a, double at_b, double& low, double& high) {
  const double slope = at_b - at_a;
  if (slope == 0) {
    if (at_a < 0) high = low - 1;
    return;
  }
  const double zero = -at_a / slope;
  if (slope > 0) {
    low = std::max(low, zero);
  } else {
    high = std::min(high, zero);
  }
}

}  // namespace

int LineInView::shown_count() const {
  return static_cast<int>(std::count(shown.begin(), shown.end(), 1));
}

std::optional<LineInView> line_in_view(const PlacedCamera& camera,
                                       const Vector3d& a_m,
                                       const Vector3d& b_m,
                                       double margin_px) {
  const Vector3d a = camera.T_camera_world * a_m, b = camera.T_camera_world * b_m, d = b - a;
  double low = 0, high = 1;
  clip(a.z() - nearest_m, b.z() - nearest_m, low, high);
  const Vector3d least = camera.ray({margin_px, margin_px});
  const Vector3d most =
      camera.ray(camera.size_px.cast<double>() - Vector2d::Constant(1 + margin_px));
  for (int i = 0; i < 2; ++i) {
    clip(a[i] - least[i] * a.z(), b[i] - least[i] * b.z(), low, high);
    clip(most[i] * a.z() - a[i], most[i] * b.z() - b[i], low, high);
  }
  if (!(high > low)) return {};
  const Vector3d p = a + low * d, q = a + high * d;
  const Vector2d p_px = camera.pixel(p), q_px = camera.pixel(q);
  const double length = (q_px - p_px).norm();
  if (length < 2) return {};
  LineInView line;
  line.from_px = p_px;
  line.along = (q_px - p_px) / length;
  line.across = Vector2d(-line.along.y(), line.along.x());
  const int count = static_cast<int>(length) + 1;
  for (int i = 0; i < count; ++i) {
    const double f = i / length;  // 1 / z is linear along the image
    const double t = f * p.z() / (q.z() - f * (q.z() - p.z()));
    line.at_m.emplace_back(p + t * (q - p));
  }
  line.shown.assign(line.at_m.size(), 1);
  return line;
}

void keep_where_depths_agree(const stereo::internal::DepthImage& depth,
                             double floor_m,
                             double share,
                             LineInView& line) {
  for (std::size_t i = 0; i < line.at_m.size(); ++i) {
    const double z = line.at_m[i].z();
    const Vector2d px = line.from_px + static_cast<double>(i) * line.along;
    bool agrees = false;
    for (int off = -beside_px; off <= beside_px && !agrees; ++off) {
      const Vector2d at = px + off * line.across;
      const int x = static_cast<int>(std::lround(at.x())),
                y = static_cast<int>(std::lround(at.y()));
      if (x < 0 || y < 0 || x >= depth.width_px || y >= depth.height_px) continue;
      const double there = depth(x, y);
      agrees = there > 0 && std::abs(there - z) <= floor_m + share * z;
    }
    if (!agrees) line.shown[i] = 0;
  }
}

}  // namespace vernier::sim::internal
