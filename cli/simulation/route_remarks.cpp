// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/route_remarks.h"

#include <fmt/format.h>

#include "cli/program/session.h"
#include "sim/routing/floor_plan.h"
#include "sim/routing/route_proposal.h"
#include "sim/study/blocked_route.h"
#include "sim/study/standing_place.h"
#include "sim/world.h"

namespace vernier::cli {

std::string floor_text(const RouteProposal& proposal) {
  const double all_m2 = proposal.floor_m2 + proposal.other_m2;
  std::string text =
      fmt::format("within 2 m of {:.0f} of {:.0f} m2 of floor", proposal.near_m2, all_m2);
  if (proposal.other_m2 > 0) {
    text += fmt::format(
        "; {:.0f} m2 are not connected with it by a way of {:g} m, or over a step of more "
        "than 2 cm",
        proposal.other_m2, 2 * sim::internal::robot_radius_m);
  }
  if (proposal.level_m2 > 0) {
    text += fmt::format("; {:.0f} m2 beside it are at another level, or a hole", proposal.level_m2);
  }
  if (proposal.open_m2 > 0) {
    text += fmt::format("; {:.0f} m2 beside it are open to the surroundings", proposal.open_m2);
  }
  if (proposal.is_cut_short) {
    text += fmt::format("; it ends at {} legs, the most that are proposed", proposal.route.size());
  }
  return text;
}

std::string open_floor_text(const RouteProposal& proposal) {
  if (!proposal.is_open || proposal.route.empty()) return {};
  const double widest_m = sim::internal::FloorPlan::widest_gap_m;
  if (proposal.gap_m == 0) {
    return fmt::format(
        "the route is on open floor without walls around; if it should be in a room, close its "
        "gaps of {:g} m and more, open a door if it is closed, or give [[route]] points_m",
        widest_m);
  }
  return fmt::format(
      "the floor of the route is open to the surroundings by a gap of about {:.1f} m or less; if "
      "the route should not lead there, close the gap, or give [[route]] points_m",
      proposal.gap_m);
}

void tell_blocked_route(const World& world,
                        const std::string& name,
                        double eye_height_m,
                        Session& session) {
  constexpr double most = 0.1;
  const sim::internal::RouteFault route = sim::internal::route_fault(world, eye_height_m);
  if (route.fault.empty()) return;
  const std::string text = name + ": its route " + route.fault + "; " + route.remedy;
  route.share < most ? session.warn(text) : session.add_trust_warning(text);
}

}  // namespace vernier::cli
