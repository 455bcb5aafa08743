// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calib/rig.h"
#include "sim/told_rigs.h"

namespace vernier::sim::internal {

/// Throws Error(`place`) unless the rigs have as many cameras, of the same image sizes.
void check_same_cameras(const Rig& truth, const Rig& rig, const std::string& place);

/// Throws Error(`place`) if psi_c is neither 0 nor 1 and lens models differ.
void check_scale(const Rig& truth, const Rig& rig, double psi_c, const std::string& place);

/// truth ⊕ ψ_c (rig ⊖ truth), to the bit `truth` at 0 and `rig` at 1.
Rig with_scaled_error(const Rig& truth, const Rig& rig, double psi_c);

/// The rig, or a failure that says why no rig can be like it (possible_rig.h).
ToldRig possible_only(Rig rig);

}  // namespace vernier::sim::internal
