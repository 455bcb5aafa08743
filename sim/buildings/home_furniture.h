// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/world.h"

namespace vernier::sim::internal {

inline constexpr double worktop_m = 0.9;  ///< height of a kitchen worktop

/// Templates of homes. Their origins are as those of office_templates(): at the wall for what
/// stands or hangs there, at the centre for coffee and dining tables, chairs, rugs, lamps and
/// plants.
std::vector<WorldTemplate> home_templates();

}  // namespace vernier::sim::internal
