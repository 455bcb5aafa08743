// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/camera_scales.h"

#include <algorithm>
#include <cmath>

#include "calib/noise/frame_rows.h"

namespace vernier::internal {
namespace {

constexpr double alike_within = 1.25;

Eigen::Index coordinates(const ViewRows& view) {
  return 2 * static_cast<Eigen::Index>(view.ids.size());
}

}  // namespace

Eigen::VectorXd camera_scales(const std::vector<FrameRows>& frames) {
  Eigen::Index cameras = 0;
  for (const FrameRows& rows : frames) {
    for (const ViewRows& view : rows.views)
      cameras = std::max<Eigen::Index>(cameras, view.camera + 1);
  }
  Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(cameras), counts = squares;
  for (const FrameRows& rows : frames) {
    for (const ViewRows& view : rows.views) {
      squares[view.camera] += rows.residual_px.segment(view.first, coordinates(view)).squaredNorm();
      counts[view.camera] += static_cast<double>(coordinates(view));
    }
  }
  Eigen::VectorXd scales = Eigen::VectorXd::Ones(cameras);
  const double pooled = squares.sum() / counts.sum();
  if (!(pooled > 0)) return scales;
  double least = 1, most = 1;
  for (Eigen::Index c = 0; c < cameras; ++c) {
    if (squares[c] > 0) scales[c] = std::sqrt(squares[c] / counts[c] / pooled);
    least = std::min(least, scales[c]);
    most = std::max(most, scales[c]);
  }
  if (most < alike_within * least) scales.setOnes();
  return scales;
}

void divide_by_camera(const Eigen::VectorXd& scales, std::vector<FrameRows>& frames) {
  for (FrameRows& rows : frames) {
    for (const ViewRows& view : rows.views) {
      const double s = scales[view.camera];
      if (s == 1) continue;
      const Eigen::Index first = view.first, n = coordinates(view);
      rows.residual_px.segment(first, n) /= s;
      rows.by_rig.middleRows(first, n) /= s;
      rows.by_pose.middleRows(first, n) /= s;
      rows.by_motion.middleRows(first, n) /= s;
      rows.by_point.middleRows(first, n) /= s;
    }
  }
}

}  // namespace vernier::internal
