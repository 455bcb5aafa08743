// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/program/namespaces.h"
#include "cli/program/session.h"
#include "sim/routing/route_proposal.h"
#include "sim/world.h"

namespace vernier::cli {

/// How much floor a proposed route comes near, and how much the robot has no way to.
std::string floor_text(const RouteProposal& proposal);

/// What a route on open floor lacks: walls around, or by what gap they are open. Empty on floor
/// that is enclosed, and without a route.
std::string open_floor_text(const RouteProposal& proposal);

/// A world's route where a robot cannot stand: a warning, or a reason not to trust the results if
/// it is a tenth of the route and more.
void tell_blocked_route(const World& world,
                        const std::string& name,
                        double eye_height_m,
                        Session& session);

}  // namespace vernier::cli
