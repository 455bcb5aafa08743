// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calib/rig_estimate.h"

namespace vernier::internal {

/// Descriptions of the excluded corners, by frame and camera: one line for a view that was excluded
/// as a whole, such as "all 54 corners of frame 3, right, 3.1 to 9.8 px from their predictions",
/// else one per corner. Unknown distances are omitted.
std::vector<std::string> outlier_lines(const RigEstimate& estimate);

}  // namespace vernier::internal
