// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/program/namespaces.h"
#include "localise/place.h"
#include "sim/world.h"

namespace vernier::cli {

/// A way that is drawn into a plan.
struct PlanWay {
  std::string name, colour;
  std::vector<Pose2D> poses;
};

/// The floor plan of a world as SVG: what stands below 2 m, and the route, each leg with an arrow;
/// or instead of the route these ways, each with a ring where it begins and its name at the foot.
std::string plan_svg(const World& world, const std::vector<PlanWay>& ways = {});

}  // namespace vernier::cli
