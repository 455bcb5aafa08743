// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "calib/formats/rig_json.h"
#include "calib/rig.h"
#include "cli/program/session.h"
#include "sim/world.h"

namespace vernier::cli {

/// Adds `vernier world sets`.
void add_world_sets(CLI::App& world, Session& session);

/// How far the view sets of a world agree with exact visibility, at poses beside its route.
struct SetFigures {
  Json json;
  std::string text;
};
SetFigures set_figures(const World& world, const Rig& rig, int poses, double height_m = 1.2);

}  // namespace vernier::cli
