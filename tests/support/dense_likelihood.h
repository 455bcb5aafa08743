// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/noise/corner_noise.h"
#include "calib/noise/frame_rows.h"

namespace vernier::test {

/// The restricted likelihood of calib/noise/restricted_likelihood.h as it is written there, every
/// matrix dense and of all frames at once, the shape in V. Components of zero are not there.
class DenseLikelihood {
 public:
  DenseLikelihood(std::vector<vernier::internal::FrameRows> frames,
                  std::vector<Eigen::Vector3d> target_m);

  Eigen::MatrixXd V(const vernier::internal::CornerNoise& noise) const;
  /// P = V⁻¹ − V⁻¹ X (Xᵀ V⁻¹ X)⁻¹ Xᵀ V⁻¹, X of rig and poses
  Eigen::MatrixXd P(const vernier::internal::CornerNoise& noise) const;
  double minus_two_log(const vernier::internal::CornerNoise& noise) const;

  const Eigen::VectorXd& residuals_px() const { return r_; }
  /// Columns of the motion of one frame, rows of all frames.
  Eigen::MatrixXd by_motion(std::size_t frame) const;

 private:
  std::vector<vernier::internal::FrameRows> frames_;
  std::vector<Eigen::Vector3d> target_m_;
  std::vector<Eigen::Index> first_;  // row of each frame
  Eigen::MatrixXd X_, D_;
  Eigen::VectorXd r_;
};

}  // namespace vernier::test
