// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// map_growth nodes [HEADINGS] | buildings: how time and memory of a localiser grow with its map.
//
//   nodes      one map of 100 to 100,000 nodes: offices of 20 x 15 m, seeds 301 on, side by side.
//              The queries stand in the first, among all others of its kind
//   buildings  one office a map, from 20 x 15 to 200 x 150 m (seed 301)
//
// Prints comma-separated values. Times are CPU times of one thread; memory is what the allocator
// has handed out. Nothing was tuned on these seeds.
#include <malloc.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/shipped.h"
#include "localise/localiser.h"
#include "localise/map_file.h"
#include "localise/topological_map.h"
#include "sim/buildings/office.h"
#include "sim/experiment.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace {

using namespace vernier;
using namespace vernier::sim;
using namespace vernier::sim::internal;

constexpr std::uint64_t first_seed = 301;
constexpr std::uint32_t queries = 200;

double cpu_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double heap_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

/// An office, and what can be recorded in it.
struct Building {
  World world;
  Visibility visibility{world};
  RigEstimate rig = datasets::nominal();
  std::unique_ptr<LocalisationExperiment> experiment;

  Building(std::uint64_t seed, const OfficeOptions& options, const ExperimentSettings& settings)
      : world(build_world(make_office(seed, options))) {
    auto views = std::make_shared<MapViews>(map_views(visibility, rig.rig, settings));
    experiment =
        std::make_unique<LocalisationExperiment>(visibility, rig, std::move(views), settings);
  }
  localise::TopologicalMap map() const {
    return experiment->record_map(0, experiment->map_estimator_rig(0));
  }
};

/// A line of the table.
void measure(const std::string& label,
             const LocalisationExperiment& experiment,
             const localise::TopologicalMap& map,
             double map_bytes) {
  const auto file = std::filesystem::temp_directory_path() /
                    ("map_growth_" + std::to_string(std::clock()) + ".vmap");
  localise::write_map(file, map);
  const auto file_bytes = static_cast<double>(std::filesystem::file_size(file));
  std::filesystem::remove(file);

  const double before = heap_bytes(), start = cpu_s();
  const auto localiser = localise::make_localiser("lines", map);
  const double built_s = cpu_s() - start, index_bytes = heap_bytes() - before;

  std::vector<double> times;
  int right = 0, answered = 0, answered_right = 0;
  for (std::uint32_t trial = 0; trial < queries; ++trial) {
    const TrialResult result =
        experiment.run_trial(trial, experiment.estimator_rig(trial), map, *localiser);
    times.push_back(result.cpu_ms);
    right += result.error <= success_radius_m;
    answered += result.answered();
    answered_right += result.success();
  }
  std::sort(times.begin(), times.end());
  double sum = 0;
  for (const double t : times) sum += t;
  const auto nodes = static_cast<double>(map.nodes.size());
  std::printf("%s,%zu,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.1f,%d,%d\n", label.c_str(),
              map.nodes.size(), map_bytes / nodes / 1e3, index_bytes / nodes / 1e3,
              file_bytes / nodes / 1e3, built_s, sum / queries, times[queries / 2],
              times[queries * 95 / 100], 100.0 * right / queries, answered, answered_right);
  std::fflush(stdout);
}

void head() {
  std::puts(
      "map,nodes,map_kb_node,index_kb_node,file_kb_node,build_cpu_s,query_ms_mean,query_ms_median,"
      "query_ms_p95,best_guess_success,answered,answered_right");
}

ExperimentSettings settings_for(int headings) {
  ExperimentSettings settings;
  settings.sources.calibration = 1;
  settings.map_headings = headings;
  settings.protocol = headings > 0 ? QueryProtocol::anywhere : QueryProtocol::path;
  return settings;
}

void grow_nodes(int headings) {
  head();
  const ExperimentSettings settings = settings_for(headings);
  const Building first(first_seed, {}, settings);
  localise::TopologicalMap map;
  std::uint64_t seed = first_seed;
  const double before = heap_bytes();
  for (const std::size_t size : {100, 300, 1000, 3000, 10000, 30000, 100000}) {
    while (map.nodes.size() < size) {
      localise::TopologicalMap more =
          seed == first_seed ? first.map() : Building(seed, {}, settings).map();
      const double aside_m = 40.0 * static_cast<double>(seed - first_seed);
      for (localise::MapNode& node : more.nodes) {
        node.pose.x_m += aside_m;
        map.nodes.push_back(std::move(node));
      }
      ++seed;
    }
    localise::TopologicalMap part;
    part.nodes.assign(map.nodes.begin(), map.nodes.begin() + static_cast<std::ptrdiff_t>(size));
    const double kept = heap_bytes() - before;
    measure("offices", *first.experiment, part,
            kept * static_cast<double>(size) / static_cast<double>(map.nodes.size() + size));
  }
}

void grow_building() {
  head();
  for (const double scale : {1.0, 2.0, 4.0, 10.0}) {
    OfficeOptions options;
    options.size_m = {20 * scale, 15 * scale, options.size_m.z()};
    const Building building(first_seed, options, settings_for(0));
    const double before = heap_bytes();
    const localise::TopologicalMap map = building.map();
    char label[64];
    std::snprintf(label, sizeof label, "%.0f x %.0f m", 20 * scale, 15 * scale);
    measure(label, *building.experiment, map, heap_bytes() - before);
  }
}

}  // namespace

int main(int count, char** words) {
  const std::string_view what = count > 1 ? words[1] : "";
  if (what != "nodes" && what != "buildings") {
    std::fprintf(stderr, "usage: map_growth nodes [HEADINGS] | buildings\n");
    return 2;
  }
  try {
    if (what == "nodes") {
      grow_nodes(count > 2 ? std::atoi(words[2]) : 8);
    } else {
      grow_building();
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "map_growth: %s\n", error.what());
    return 1;
  }
  return 0;
}
