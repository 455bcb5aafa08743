// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "localise/place.h"

namespace vernier::localise::internal {

/// Throws Error naming `place` unless all pixels are finite and all covariances positive definite.
void check_corners(std::span<const StereoCorner> corners, const std::string& place);

}  // namespace vernier::localise::internal
