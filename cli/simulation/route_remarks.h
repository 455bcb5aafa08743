// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/program/namespaces.h"
#include "sim/routing/route_proposal.h"

namespace vernier::cli {

/// How much floor a proposed route comes near, and how much the robot has no way to.
std::string floor_text(const RouteProposal& proposal);

/// What a route on open floor lacks: walls around, or by what gap they are open. Empty on floor
/// that is enclosed, and without a route.
std::string open_floor_text(const RouteProposal& proposal);

}  // namespace vernier::cli
