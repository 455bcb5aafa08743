// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/noise/corner_noise.h"
#include "calib/noise/frame_rows.h"

namespace vernier::internal {

/// V_f of calib/noise/corner_noise.h (px²) in the order of the frame's rows. The shape, a part of
/// the board and not of the frame, is not in it.
Eigen::MatrixXd corner_covariance(const FrameRows& rows,
                                  const CornerNoise& noise,
                                  const std::vector<Eigen::Vector3d>& target_m);

}  // namespace vernier::internal
