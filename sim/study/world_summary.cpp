// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/world_summary.h"

#include <fmt/format.h>

#include <map>
#include <set>
#include <string>
#include <utility>

#include "calib/interval.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/success_interval.h"

namespace vernier::sim::internal {

namespace {

constexpr const char* world_key = "world.file";

/// The world of a cell, and what remains of its swept keys and values without it.
std::pair<std::string, std::string> world_and_rest(const StudyCell& cell) {
  std::string world, rest;
  for (const auto& [key, value] : cell.swept) {
    if (key == world_key) {
      world = value;
    } else {
      rest += (rest.empty() ? "" : ", ") + key + " = " + value;
    }
  }
  return {world, rest};
}

void add_figures(const std::vector<CellResult>& cells, WorldSummary& summary) {
  std::vector<ClusterCount> worlds;
  ClusterCount all;
  for (const std::size_t cell : summary.cells) {
    ClusterCount world;
    for (const ClusterCount& map : cells[cell].maps) {
      world.successes += map.successes;
      world.trials += map.trials;
    }
    if (world.trials == 0) continue;
    worlds.push_back(world);
    all.successes += world.successes;
    all.trials += world.trials;
  }
  summary.worlds = static_cast<int>(worlds.size());
  if (all.trials > 0) summary.success = static_cast<double>(all.successes) / all.trials;
  summary.success_interval_95 = interval_over_worlds_95(worlds);
  if (!summary.success_interval_95) {
    summary.why_no_interval = fmt::format("needs {} worlds, has {}", fewest_worlds, summary.worlds);
  }
}

}  // namespace

std::vector<WorldSummary> summarise_over_worlds(const std::vector<CellResult>& cells) {
  std::vector<WorldSummary> summaries;
  std::map<std::string, std::size_t> at;
  std::set<std::string> all_worlds;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto [world, rest] = world_and_rest(cells[i].cell);
    if (world.empty()) continue;
    all_worlds.insert(world);
    const auto [found, is_new] = at.try_emplace(rest, summaries.size());
    if (is_new) {
      summaries.emplace_back();
      summaries.back().label = rest.empty() ? "all worlds" : rest;
    }
    summaries[found->second].cells.push_back(i);
  }
  if (all_worlds.size() < 2) return {};
  for (WorldSummary& summary : summaries) add_figures(cells, summary);
  return summaries;
}

}  // namespace vernier::sim::internal
