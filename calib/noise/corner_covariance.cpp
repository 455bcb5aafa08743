// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/corner_covariance.h"

#include <cstddef>

#include "calib/noise/corner_noise.h"
#include "calib/noise/field_spectrum.h"
#include "calib/noise/frame_rows.h"

namespace vernier::internal {

Eigen::MatrixXd corner_covariance(const FrameRows& rows,
                                  const CornerNoise& noise,
                                  const std::vector<Eigen::Vector3d>& target_m) {
  const Eigen::Index count = rows.residual_px.size();
  Eigen::MatrixXd V = noise.white_px * noise.white_px * Eigen::MatrixXd::Identity(count, count);
  for (const ViewRows& view : rows.views) {
    if (!(noise.field_px > 0)) break;
    std::vector<Eigen::Vector3d> seen;
    for (const int id : view.ids) seen.push_back(target_m[static_cast<std::size_t>(id)]);
    const auto n = static_cast<Eigen::Index>(seen.size());
    const Eigen::MatrixXd K =
        noise.field_px * noise.field_px * field_correlation(seen, noise.field_length_m);
    V.block(view.first, view.first, n, n) += K;
    V.block(view.first + n, view.first + n, n, n) += K;
  }
  const Eigen::VectorXd variances = motion_sigmas(noise, rows.by_motion.cols()).cwiseAbs2();
  V += rows.by_motion * variances.asDiagonal() * rows.by_motion.transpose();
  return V;
}

}  // namespace vernier::internal
