// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/work_units.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/error_place.h"
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

UnitComputer::UnitComputer(const Study& study, const StudyWork& work)
    : study_(study), work_(work), scenes_(study) {
  for (const StudyCell& cell : study.file.cells) {
    if (!cell.system.is_localiser()) {
      with_errors_of(place_of(study.file, "system.name"), [&] { return system(cell); });
      continue;
    }
    StudyCell still = cell;
    still.experiment.sources.moved = 0;  // a changed world takes time
    const LocalisationExperiment tried(scenes_.visibility(cell), study.rig, nullptr,
                                       still.experiment, scenes_.queries(still).places, nullptr,
                                       scenes_.told(cell));
  }
  try_program();
}

void UnitComputer::try_program() const {
  const StudyCell& cell = study_.file.cells[0];
  const auto command = cell.system.options.find("command");
  if (command == cell.system.options.end() || command->second.empty()) return;
  constexpr std::uint32_t tried = 3;
  const std::unique_ptr<SystemUnderTest> asked = system(cell);
  std::string why;
  for (std::uint32_t trial = 0; trial < tried; ++trial) {
    const TrialResult result = asked->run(trial);
    if (result.status != localise::LocalisationStatus::failed) return;
    if (why.empty()) why = result.failure;
  }
  throw Error(place_of(study_.file, "system.command"),
              fmt::format("the program failed in the first {} trials: {}", tried, why),
              "run it by hand with a question of docs/systems.md");
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
  if (unit.block >= 0) return {block(work_.blocks[static_cast<std::size_t>(unit.block)]), {}};
  return {{}, queries(unit, stop)};
}

BlockRow UnitComputer::block(const BlockJob& job) const {
  const StudyCell& cell = study_.file.cells[static_cast<std::size_t>(job.cell)];
  const TrialBlock trials{.block = static_cast<std::uint32_t>(job.block),
                          .first = static_cast<std::uint32_t>(job.first),
                          .count = static_cast<std::uint32_t>(job.count)};
  return block_row(work_.cell_keys[static_cast<std::size_t>(job.cell)], job.block,
                   with_errors_of(cell.world, [&] {
                     return cell.system.is_localiser() ? localisations(cell, trials)
                                                       : run_block(*system(cell), trials);
                   }));
}

std::vector<TrialResult> UnitComputer::localisations(const StudyCell& cell,
                                                     const TrialBlock& trials) const {
  const QueryWorld world = scenes_.queries(cell);
  const LocalisationExperiment experiment(scenes_.visibility(cell), study_.rig,
                                          looks_.at(looks_key(cell)), cell.experiment, world.places,
                                          world.changed, scenes_.told(cell));
  return experiment.run_block(trials);
}

std::unique_ptr<SystemUnderTest> UnitComputer::system(const StudyCell& cell) const {
  const SystemKind& kind = system_kind(cell.system.name);
  return kind.make({.cell = cell,
                    .visibility = scenes_.visibility(cell),
                    .rig = study_.rig,
                    .places = kind.uses_protocol ? scenes_.queries(cell).places : nullptr,
                    .told = scenes_.told(cell),
                    .calibrations = scenes_.calibrations(cell)});
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
