// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calib/rig.h"
#include "calib/rig_estimate.h"

namespace vernier::internal {

/// Throws Error (naming `place_b`) where the rigs are not of the same cameras: their number, their
/// names or their image sizes.
void check_same_cameras(const Rig& a, const Rig& b, const std::string& place_b);

/// How many views (of one camera in one frame) of `a` are the same image in `b`: the pixels of the
/// corners that both found are the same, or the image's name is and they lie within 2 px (rms, per
/// coordinate).
int shared_views(const CalibrationEvidence& a,
                 const Rig& rig_a,
                 const CalibrationEvidence& b,
                 const Rig& rig_b);

}  // namespace vernier::internal
