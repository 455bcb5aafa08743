// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/rig.h"

namespace vernier::internal {

/// Throws Error unless `other` is a camera of the rig with a pose, and not its first.
void check_other(const Rig& rig, int other);

}  // namespace vernier::internal
