// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "calib/rig.h"

namespace vernier::sim::internal {

/// Pixels by which a line moves across itself in the right image where it moves by one in the left
/// image, as an edge does that is displaced in space at constant depth, so that its disparity
/// stays. Ends of the edge in the left camera's frame, before both cameras. Its middle stands for
/// all of it.
double right_by_left_shift(const Rig& rig, const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m);

}  // namespace vernier::sim::internal
