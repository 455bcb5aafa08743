// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/rig.h"

namespace vernier::internal {

/// Whether both rigs have as many cameras, of the same lens models.
bool same_lens_models(const Rig& a, const Rig& b);

}  // namespace vernier::internal
