// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/rig_estimate.h"

namespace vernier::internal {

/// The pair of a rig's first camera and another, with the corresponding part of both covariances,
/// for functions of a pair. The other cameras' errors are marginalised, not fixed. The evidence is
/// dropped, since it is of all cameras. Throws Error unless `other` is a camera of the rig and not
/// its first.
RigEstimate pair_of(const RigEstimate& estimate, int other);

}  // namespace vernier::internal
