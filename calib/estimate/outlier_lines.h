// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calib/rig_estimate.h"

namespace vernier::internal {

/// The corners left out of a calibration in words, by frame and camera: one line for a view of
/// which the evidence holds nothing, such as "all 54 corners of frame 3, right, 3.1 to 9.8 px from
/// their places", else one a corner. Distances that are not known are not given.
std::vector<std::string> outlier_lines(const RigEstimate& estimate);

}  // namespace vernier::internal
