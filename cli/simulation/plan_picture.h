// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/program/namespaces.h"
#include "sim/world.h"

namespace vernier::cli {

/// The floor plan of a world as SVG: what stands below 2 m, and the route, each leg with an arrow.
std::string plan_svg(const World& world);

}  // namespace vernier::cli
