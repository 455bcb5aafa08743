// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/rig.h"
#include "cli/program/session.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "stereo/segment.h"

namespace vernier::cli {

/// Its ends: u, v, u, v.
Json segment_json(const ImageSegment& segment);

/// A view with ground truth: segments as [u1, v1, u2, v2] in pixels of each camera, with the index
/// of their edge in the world (docs/file-formats.md).
Json sighting_json(const Rig& rig, const NoiseFreeView& seen, const StereoObservation& sighting);

/// 3D segments, in the left camera frame of the rig used for reconstruction.
Json space_json(const std::vector<SpaceSegment>& lines);

}  // namespace vernier::cli
