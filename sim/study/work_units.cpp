// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/work_units.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/error_place.h"
#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "sim/experiment.h"
#include "sim/noise_free_view.h"
#include "sim/study/ceiling.h"
#include "sim/study/store_rows.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_keys.h"
#include "sim/study/study_scenes.h"
#include "sim/study/study_work.h"
#include "sim/study/system_kind.h"
#include "sim/study/system_under_test.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

std::vector<WorkUnit> block_units(const MissingWork& missing) {
  std::vector<WorkUnit> units;
  for (const int block : missing.blocks) units.push_back({.block = block});
  return units;
}

std::vector<WorkUnit> query_units(const MissingWork& missing) {
  constexpr std::size_t parts = 250, most = 20;
  std::vector<WorkUnit> units;
  for (std::size_t c = 0; c < missing.queries.size(); ++c) {
    const std::vector<int>& all = missing.queries[c];
    const std::size_t size = std::clamp(all.size() / parts, std::size_t{1}, most);
    for (std::size_t first = 0; first < all.size(); first += size) {
      const std::size_t end = std::min(first + size, all.size());
      units.push_back({.ceiling = static_cast<int>(c),
                       .queries = {all.begin() + static_cast<std::ptrdiff_t>(first),
                                   all.begin() + static_cast<std::ptrdiff_t>(end)}});
    }
  }
  return units;
}

UnitComputer::UnitComputer(const Study& study, const StudyWork& work, const std::stop_token& stop)
    : study_(study), work_(work), scenes_(study) {
  try_programs(stop);
  for (const StudyCell& cell : study.file.cells) {
    if (!cell.system.is_localiser()) {
      if (stop.stop_requested()) return;
      if (!system_kind(cell.system.name).is_program) system(cell);
      continue;
    }
    StudyCell still = cell;
    still.experiment.sources.moved = 0;  // a changed world takes time
    const LocalisationExperiment tried(scenes_.visibility(cell), study.rig, nullptr,
                                       still.experiment, scenes_.queries(still).places, nullptr,
                                       scenes_.told(cell));
  }
}

void UnitComputer::try_programs(const std::stop_token& stop) const {
  std::set<std::string> tried;
  for (const StudyCell& cell : study_.file.cells) {
    const std::string command = cell.system.command();
    if (!command.empty() && tried.insert(command).second) try_program(cell, stop);
  }
}

void UnitComputer::try_program(const StudyCell& cell, const std::stop_token& stop) const {
  constexpr int most_failures = 3;
  constexpr std::uint32_t most_trials = 30;
  const Lease asked = system(cell);
  std::string why;
  int failures = 0;
  for (std::uint32_t trial = 0; trial < most_trials && failures < most_failures; ++trial) {
    if (stop.stop_requested()) return;
    const TrialResult result = asked->run(trial);
    if (result.status != localise::LocalisationStatus::failed) return;
    if (result.wall_ms == 0) continue;  // the program was not asked
    if (failures++ == 0) why = result.failure;
  }
  if (failures < most_failures) return;
  const std::string command = cell.system.command();
  const bool names_it = why.find(command) != std::string::npos;
  throw Error(place_of(study_.file, "system.command"),
              fmt::format("the program{} failed in the first {} trials: {}",
                          names_it ? "" : " " + in_quotes(command), failures, why),
              "run it by hand (docs/systems.md, docs/matchers.md)");
}

void UnitComputer::prepare_maps() {
  for (const StudyCell& cell : study_.file.cells) {
    if (!cell.system.is_localiser()) continue;
    auto& shared = looks_[looks_key(cell)];
    if (shared) continue;
    shared = std::make_shared<MapViews>(with_errors_of(cell.world, [&] {
      return map_views(scenes_.visibility(cell), study_.rig.rig, cell.experiment);
    }));
  }
}

UnitResult UnitComputer::compute(const WorkUnit& unit, const std::stop_token& stop) const {
  if (unit.block < 0) return {{}, queries(unit, stop)};
  const BlockJob& job = work_.blocks[static_cast<std::size_t>(unit.block)];
  const std::string& key = work_.cell_keys[static_cast<std::size_t>(job.cell)];
  return {block_row(key, job.block, trials(job)), {}};
}

std::vector<TrialResult> UnitComputer::trials(const BlockJob& job) const {
  const StudyCell& cell = study_.file.cells[static_cast<std::size_t>(job.cell)];
  const TrialBlock block{.block = static_cast<std::uint32_t>(job.block),
                         .first = static_cast<std::uint32_t>(job.first),
                         .count = static_cast<std::uint32_t>(job.count)};
  return with_errors_of(cell.world, [&] {
    return cell.system.is_localiser() ? localisations(cell, block)
                                      : trials_of_system(job.cell, block);
  });
}

std::vector<TrialResult> UnitComputer::localisations(const StudyCell& cell,
                                                     const TrialBlock& trials) const {
  const QueryWorld world = scenes_.queries(cell);
  const LocalisationExperiment experiment(scenes_.visibility(cell), study_.rig,
                                          looks_.at(looks_key(cell)), cell.experiment, world.places,
                                          world.changed, scenes_.told(cell));
  return experiment.run_block(trials);
}

UnitComputer::Lease UnitComputer::system(const StudyCell& cell) const {
  const SystemKind& kind = system_kind(cell.system.name);
  const bool moves = kind.sources == SourcesUsed::all && cell.experiment.sources.moved > 0;
  const QueryWorld world = kind.uses_protocol || moves ? scenes_.queries(cell) : QueryWorld{};
  try {
    return kind.make({.cell = cell,
                      .visibility = scenes_.visibility(cell),
                      .rig = study_.rig,
                      .changed = world.changed,
                      .places = world.places,
                      .told = scenes_.told(cell),
                      .calibrations = scenes_.calibrations(cell)});
  } catch (const Error& error) {  // at the line of the key that it names
    const bool has_key = error.place().starts_with("system.");
    const std::string key = error.place().substr(0, error.place().find(':'));
    throw error_of(place_of(study_.file, has_key ? key : "system.name"), error);
  }
}

UnitComputer::Lease UnitComputer::lease(int cell) const {
  {
    const std::lock_guard lock(idle_mutex_);
    const auto found = std::find_if(idle_.begin(), idle_.end(),
                                    [&](const auto& idle) { return idle.first == cell; });
    if (found != idle_.end()) {
      Lease system = std::move(found->second);
      idle_.erase(found);
      return system;
    }
  }
  return system(study_.file.cells[static_cast<std::size_t>(cell)]);
}

void UnitComputer::give_back(int cell, Lease system) const {
  constexpr std::size_t most = 32;
  Lease oldest;  // ended without the lock
  const std::lock_guard lock(idle_mutex_);
  idle_.emplace_back(cell, std::move(system));
  if (idle_.size() <= most) return;
  oldest = std::move(idle_.front().second);
  idle_.pop_front();
}

std::vector<TrialResult> UnitComputer::trials_of_system(int cell, const TrialBlock& trials) const {
  Lease leased = lease(cell);
  std::vector<TrialResult> results = run_block(*leased, trials);
  give_back(cell, std::move(leased));
  return results;
}

std::shared_ptr<const AliasFinder> UnitComputer::finder(int ceiling) const {
  const std::lock_guard lock(finder_mutex_);
  if (finder_ceiling_ == ceiling) return finder_;
  const StudyCell& cell = *work_.ceilings[static_cast<std::size_t>(ceiling)].cell;
  // Whoever uses the finder keeps the world that it refers to.
  struct Kept {
    QueryWorld world;
    AliasFinder finder;
  };
  NoiseFreeViewOptions options;
  options.mount = cell.experiment.mount;
  const QueryWorld world = scenes_.queries(cell);
  const auto kept = std::make_shared<const Kept>(
      Kept{world, AliasFinder(world.changed ? world.changed->visibility : scenes_.visibility(cell),
                              study_.rig.rig, options)});
  finder_ = std::shared_ptr<const AliasFinder>(kept, &kept->finder);
  finder_ceiling_ = ceiling;
  return finder_;
}

std::vector<std::pair<int, QueryCeiling>> UnitComputer::queries(const WorkUnit& unit,
                                                                const std::stop_token& stop) const {
  const StudyCell& cell = *work_.ceilings[static_cast<std::size_t>(unit.ceiling)].cell;
  const std::shared_ptr<const AliasFinder> aliases = finder(unit.ceiling);
  const QueryWorld world = scenes_.queries(cell);
  std::vector<std::pair<int, QueryCeiling>> found;
  for (const int query : unit.queries) {
    if (stop.stop_requested()) break;
    const localise::Pose2D pose =
        world.places->draw(cell.experiment.seed, static_cast<std::uint32_t>(query));
    found.emplace_back(query, query_ceiling(aliases->aliases(pose, world.places.get())));
  }
  return found;
}

}  // namespace vernier::sim::internal
