// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "calib/camera.h"

namespace vernier::internal {

/// Derivatives of the ray (x, y, 1) with project(ray; a) = pixel, by the implicit function: with
/// P = ∂project / ∂(x, y),
///
///     ∂ray / ∂pixel = P⁻¹,   ∂ray / ∂a = −P⁻¹ ∂project / ∂a
///
/// and zeros in the third row.
struct RayDerivatives {
  Eigen::Matrix<double, 3, 2> by_pixel = Eigen::Matrix<double, 3, 2>::Zero();
  Eigen::Matrix<double, 3, Eigen::Dynamic> by_camera;
};

RayDerivatives derivatives_of_ray(const Camera& camera, const Eigen::Vector3d& ray);

}  // namespace vernier::internal
