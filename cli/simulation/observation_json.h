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

/// A view with its truth: segments as [u1, v1, u2, v2] in pixels of each eye, and which edge of the
/// world each of them is (docs/file-formats.md).
Json sighting_json(const Rig& rig, const NoiseFreeView& seen, const StereoObservation& sighting);

/// Cameras and poses of a rig, as `cameras` of a rig.json.
Json cameras_json(const Rig& rig);

/// Segments in space, in the left camera's frame of the rig that they were reconstructed with.
Json space_json(const std::vector<SpaceSegment>& lines);

}  // namespace vernier::cli
