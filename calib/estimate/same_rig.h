// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calib/rig.h"
#include "calib/rig_estimate.h"

namespace vernier::internal {

/// Throws Error (naming `place_b`) if the rigs differ in the number, names or image sizes of their
/// cameras.
void check_same_cameras(const Rig& a, const Rig& b, const std::string& place_b);

/// Number of views (one camera in one frame) of `a` that are the same image in `b`: the pixels of
/// the common corners are equal, or the image's name is and they differ by less than 2 px (rms, per
/// coordinate).
int shared_views(const CalibrationEvidence& a,
                 const Rig& rig_a,
                 const CalibrationEvidence& b,
                 const Rig& rig_b);

}  // namespace vernier::internal
