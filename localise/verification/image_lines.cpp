// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/verification/image_lines.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "localise/place.h"
#include "localise/place/view_camera.h"

namespace vernier::localise::internal {

bool is_steep(float dx) { return std::abs(dx) < steep_below; }

std::vector<QueryLine> query_lines(const PlaceView& view, const ViewCamera& camera) {
  std::vector<QueryLine> lines;
  lines.reserve(view.lines.size());
  for (const PlaceLine& line : view.lines) {
    const Eigen::Vector3f a_m = line.a_m.cast<float>(), b_m = line.b_m.cast<float>();
    const Eigen::Vector3f a = project(camera, a_m), b = project(camera, b_m);
    const bool in_front =
        a.z() > 0 && a.z() < 1 / nearest_compared_m && b.z() > 0 && b.z() < 1 / nearest_compared_m;
    const Eigen::Vector2f d = (b - a).head<2>();
    const float length = d.norm();
    if (!in_front || !(length >= shortest_compared_px) || !std::isfinite(length)) continue;
    const Eigen::Vector3f middle = 0.5f * (a + b);
    const auto sigma = static_cast<float>(line.sigma_m);
    lines.push_back({middle.x(), middle.y(), middle.z(), d.x() / length, d.y() / length, length,
                     sigma * sigma, is_steep(d.x() / length)});
  }
  return lines;
}

void ImageLines::make_room(std::size_t lines) {
  constexpr std::size_t lanes = 16;  // kernels write whole vectors
  if (u.size() >= lines + lanes) return;
  for (auto* column :
       {&u, &v, &w, &dw, &dx, &dy, &length_px, &per_length, &variance_m2, &counted, &covered_px}) {
    column->resize(lines + lanes);
  }
}

void ImageLines::end() {
  constexpr std::ptrdiff_t lanes = 16;
  for (auto* column : {&u, &v, &w, &dw, &dx, &dy, &per_length, &variance_m2, &counted}) {
    std::fill_n(column->begin() + size, lanes, 0.0f);
  }
  std::fill_n(length_px.begin() + size, lanes, -1e9f);
  std::fill_n(covered_px.begin(), size + lanes, 0.0f);
}

LineDeviation deviation(const QueryLine& query,
                        const ImageLines& lines,
                        int line,
                        const ViewCamera& camera,
                        const LineTolerance& tolerance) {
  const float ru = query.u - lines.u[line], rv = query.v - lines.v[line];
  const float along = ru * lines.dx[line] + rv * lines.dy[line];
  const float t = std::clamp(along * lines.per_length[line], 0.0f, 1.0f);
  const float w = lines.w[line] + t * lines.dw[line];
  const float fB = camera.disparity_px_m(), bw = fB * w;
  const float position_px = camera.f_px * tolerance.offset_m * w;
  const float share_px = tolerance.disparity_share * bw, range_px_m = bw * w;
  LineDeviation d;
  d.offset_sigma_px = std::hypot(tolerance.offset_px, position_px);
  d.disparity_sigma_px =
      std::sqrt(tolerance.disparity_px * tolerance.disparity_px + share_px * share_px +
                0.5f * range_px_m * range_px_m * (query.variance_m2 + lines.variance_m2[line]));
  d.offset = (rv * lines.dx[line] - ru * lines.dy[line]) / d.offset_sigma_px;
  d.disparity = fB * (w - query.w) / d.disparity_sigma_px;
  return d;
}

}  // namespace vernier::localise::internal
