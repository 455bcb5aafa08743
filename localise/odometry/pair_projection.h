// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "calib/camera.h"
#include "calib/rig.h"

namespace vernier::localise::internal {

using PairPixels = Eigen::Vector4d;  ///< left u, v, right u, v
using PairByPoint = Eigen::Matrix<double, 4, 3>;

/// Projects points in the left camera's frame into both cameras of a rig. Keeps its working memory.
class PairProjector {
 public:
  /// The rig must outlive it.
  explicit PairProjector(const Rig& rig) : rig_(rig) {}

  const Rig& rig() const { return rig_; }
  /// False if the point is not in front of both cameras.
  bool project(const Eigen::Vector3d& x_m, PairPixels& pixels, PairByPoint& by_point);
  /// Derivative of the last projected point's pixels by the rig's parameters: 4 x parameters.
  Eigen::Matrix<double, 4, Eigen::Dynamic> by_rig() const;

 private:
  const Rig& rig_;
  ProjectionJacobian left_, right_;
  Eigen::Vector3d in_right_m_{0, 0, 1};
};

}  // namespace vernier::localise::internal
