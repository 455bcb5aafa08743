// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/rig_estimate.h"
#include "cli/localisation/view_options.h"
#include "cli/program/session.h"
#include "localise/localiser.h"
#include "localise/topological_map.h"
#include "sim/experiment.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::cli {

/// A trial with the whole of its last answer.
struct SimulatedQuery {
  TrialResult result;
  LocalisationAnswer answer;
};

/// A robot in a world, as studies have it: errors of its rig's calibration and of what it sees.
class SimulatedRobot {
 public:
  /// `settings` are those of the experiment but for rig, mount, sources and seed, which are
  /// options.
  SimulatedRobot(const ViewOptions& options, ExperimentSettings settings, Session& session);
  // The experiment refers to the visibility.
  SimulatedRobot(const SimulatedRobot&) = delete;
  SimulatedRobot& operator=(const SimulatedRobot&) = delete;

  const RigEstimate& rig() const { return rig_; }
  const World& world() const { return world_; }
  /// The map of a drive along the world's route; drives differ in every draw.
  TopologicalMap record_map(std::uint32_t drive) const;
  /// The result of a query on a map, from a place drawn beside the route.
  SimulatedQuery run_query(std::uint32_t query,
                           const TopologicalMap& map,
                           const Localiser& by) const;

 private:
  World world_;
  Visibility visibility_;
  RigEstimate rig_;
  ExperimentSettings settings_;
};

}  // namespace vernier::cli
