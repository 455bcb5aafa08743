// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/rig.h"
#include "cli/program/session.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"

namespace vernier::cli {

/// A view with its truth: segments as [u1, v1, u2, v2] in pixels of each eye.
///
///     {"pose": [x, y, heading_deg], "true": {"left": […], "right": […]},
///      "sensed": {"left": […], "right": […], "feature": […]}, "corners": {"left": […], "right":
///      […], "mismatched": […]}}
Json sighting_json(const Rig& rig, const NoiseFreeView& seen, const StereoObservation& sighting);

}  // namespace vernier::cli
