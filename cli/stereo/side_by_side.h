// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "calib/rig.h"

namespace vernier::cli {

/// Throws Error (`place`) for a pair of which one camera is behind the other: no plane holds both
/// images.
void require_side_by_side(const Rig& rig, const std::string& place);

}  // namespace vernier::cli
