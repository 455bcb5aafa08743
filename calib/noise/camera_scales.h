// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/noise/frame_rows.h"

namespace vernier::internal {

/// What the noise of cameras is taken to be.
enum class CameraNoise { alike, of_each };

/// Standard deviations of the cameras' residuals over that of all coordinates; all 1 unless one is
/// 1.25 times another: less than that makes no test wrong, and of few views it is chance. 1 of a
/// camera without views.
Eigen::VectorXd camera_scales(const std::vector<FrameRows>& frames);

/// Divides the rows of each camera, residuals and derivatives, by its scale. Noise of covariance
/// s² (w² I + g² K) in a camera of scale s is then that of the model (calib/noise/corner_noise.h).
void divide_by_camera(const Eigen::VectorXd& scales, std::vector<FrameRows>& frames);

}  // namespace vernier::internal
