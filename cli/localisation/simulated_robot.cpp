// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/localisation/simulated_robot.h"

#include <memory>
#include <string>
#include <utility>

#include "calib/base/error_place.h"
#include "calib/rig_estimate.h"
#include "cli/localisation/view_options.h"
#include "cli/program/rig_input.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "cli/simulation/route_remarks.h"
#include "cli/simulation/source_options.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "localise/topological_map.h"
#include "sim/experiment.h"
#include "sim/sources.h"
#include "sim/world.h"
#include "sim/world_file.h"

namespace vernier::cli {
namespace {

RigEstimate rig_of_robot(const std::string& name, bool with_covariance, Session& session) {
  const ReadRig file = read_named_rig(name, session);
  if (with_covariance) required_covariance(file.estimate, name);
  return file.estimate;
}

/// A localiser whose last answer is kept.
class Overheard : public Localiser {
 public:
  Overheard(const Localiser& by, LocalisationAnswer& answer) : by_(by), answer_(answer) {}

  LocalisationAnswer localise(const PlaceView& query) const override {
    return answer_ = by_.localise(query);
  }
  LocalisationAnswer localise_looks(std::span<const Look> looks) const override {
    return answer_ = by_.localise_looks(looks);
  }

 private:
  const Localiser& by_;
  LocalisationAnswer& answer_;
};

}  // namespace

SimulatedRobot::SimulatedRobot(const ViewOptions& options,
                               ExperimentSettings settings,
                               Session& session)
    : world_(build_world(read_world(find_world(options.world)))),
      visibility_(world_),
      settings_(std::move(settings)) {
  settings_.mount = options.mount();
  tell_blocked_route(world_, options.world, settings_.mount.height_m, session);
  settings_.sources = sources_of(options.sources);
  settings_.seed = options.seed;
  settings_.localiser.corners = settings_.localiser.corners || options.corners;
  rig_ = rig_of_robot(options.rig_or_default(), settings_.sources.calibration > 0, session);
}

TopologicalMap SimulatedRobot::record_map(std::uint32_t drive) const {
  const auto views = std::make_shared<const MapViews>(map_views(visibility_, rig_.rig, settings_));
  const LocalisationExperiment robot(visibility_, rig_, views, settings_);
  return robot.record_map(drive, robot.map_estimator_rig(drive));
}

SimulatedQuery SimulatedRobot::run_query(std::uint32_t query,
                                         const TopologicalMap& map,
                                         const Localiser& by) const {
  const LocalisationExperiment robot(visibility_, rig_, nullptr, settings_);
  SimulatedQuery run;
  run.result = robot.run_trial(query, robot.estimator_rig(query), map, Overheard(by, run.answer));
  if (run.result.status == LocalisationStatus::failed) {  // a source may have, without an answer
    run.answer.status = run.result.status;
    run.answer.failure = run.result.failure;
  }
  return run;
}

}  // namespace vernier::cli
