// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/rig_estimate.h"

namespace vernier::internal {

/// The pair of a rig's first camera and another, with the part of both covariances that is theirs:
/// what the functions of a pair need from a rig of many. The other cameras' errors are averaged
/// over, not held. Its evidence is left out, since it is of all cameras. Throws Error unless
/// `other` is a camera of the rig and not its first.
RigEstimate pair_of(const RigEstimate& estimate, int other);

}  // namespace vernier::internal
