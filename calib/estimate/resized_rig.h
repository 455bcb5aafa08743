// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "calib/rig_estimate.h"

namespace vernier::internal {

/// The same lenses with images of another size: every image is scaled by the ratio s of the widths
/// and, in height, cropped or extended evenly above and below. Parameters in pixels scale,
///
///     f' = s f,   ox' = s (ox + ½) − ½,   oy' = (h' − 1) / 2 + s (oy − (h − 1) / 2)
///
/// and so do their standard deviations (C' = D C D); all others stay. The evidence is dropped.
/// Throws Error for a size that is not positive.
RigEstimate resized(const RigEstimate& estimate, const Eigen::Vector2i& size_px);

}  // namespace vernier::internal
