// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/world.h"

namespace vernier::sim::internal {

/// Templates of corridors: closed doors (origin at the middle of the opening), benches,
/// extinguishers, handrails, exit signs (at the middle, in the ceiling), plants.
std::vector<WorldTemplate> corridor_templates();

}  // namespace vernier::sim::internal
