// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "calib/error.h"
#include "calib/rig.h"
#include "calib/statistics/quantile.h"
#include "cli/localisation/same_rig.h"
#include "cli/localisation/simulated_robot.h"
#include "cli/localisation/view_options.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/session.h"
#include "localise/map_file.h"
#include "localise/place.h"
#include "localise/topological_map.h"
#include "localise/view_file.h"
#include "sim/experiment.h"

namespace vernier::cli {
namespace {

struct MakeMapOptions {
  ViewOptions views;
  double spacing_m = 0.5;
  int headings = 0;
  std::uint32_t drive = 0;
  std::string output, extend;
};

/// Nodes of recorded views: each needs its pose, and one look.
std::vector<MapNode> nodes_of(const NamedViews& recorded, const std::string& place) {
  std::vector<MapNode> nodes;
  const Rig* rig = nullptr;
  for (std::size_t i = 0; i < recorded.views.size(); ++i) {
    const RecordedLooks& seen = recorded.views[i];
    if (!seen.pose) {
      throw Error(place, recorded.names[i] + " has no pose",
                  "add \"pose\": [x_m, y_m, heading_rad]");
    }
    for (const Look& look : seen.looks) {
      const Pose2D& first = *seen.pose;
      if (rig == nullptr) rig = look.view.rig.get();
      if (look.view.rig) check_one_rig(*rig, *look.view.rig, place, recorded.names[i]);
      nodes.push_back({{first.x_m, first.y_m, first.heading_rad + look.turn_rad}, look.view});
    }
  }
  return nodes;
}

/// Figures of a map for people.
Json figures(const TopologicalMap& map, const std::filesystem::path& file) {
  std::vector<double> lines;
  std::set<std::pair<double, double>> positions;
  std::set<const Rig*> rigs;
  Pose2D low, high;
  std::size_t empty = 0, corners = 0;
  for (std::size_t i = 0; i < map.nodes.size(); ++i) {
    const MapNode& node = map.nodes[i];
    const Pose2D& at = node.pose;
    if (i == 0) low = high = at;
    low = {std::min(low.x_m, at.x_m), std::min(low.y_m, at.y_m), 0};
    high = {std::max(high.x_m, at.x_m), std::max(high.y_m, at.y_m), 0};
    positions.insert({at.x_m, at.y_m});
    rigs.insert(node.view.rig.get());
    lines.push_back(static_cast<double>(node.view.lines.size()));
    empty += node.view.lines.empty();
    corners += node.view.corners.size();
  }
  const double bytes = static_cast<double>(std::filesystem::file_size(file));
  const double nodes = static_cast<double>(map.nodes.size());
  return {{"file", file.string()},
          {"nodes", map.nodes.size()},
          {"positions", positions.size()},
          {"lines_median", lines.empty() ? 0 : quantile(lines, 0.5, QuantileKind::linear)},
          {"nodes_without_lines", empty},
          {"corners_mean", nodes > 0 ? static_cast<double>(corners) / nodes : 0},
          {"rigs", rigs.size()},
          {"low_m", {low.x_m, low.y_m}},
          {"high_m", {high.x_m, high.y_m}},
          {"bytes", static_cast<std::uint64_t>(bytes)},
          {"bytes_per_node", nodes > 0 ? bytes / nodes : 0}};
}

void report(const std::filesystem::path& file, Session& session) {
  const TopologicalMap map = read_map(file);
  const Json json = figures(map, file);
  if (map.nodes.empty()) {
    session.add_trust_warning("the map has no nodes: nothing can be found on it");
  } else if (json["nodes_without_lines"] == map.nodes.size() && json["corners_mean"] == 0.0) {
    session.add_trust_warning("no node of the map has lines in space: nothing can be found on it");
  }
  std::string text = fmt::format(
      "{}: {} nodes at {} positions, {:.0f} lines in space each (median)\n"
      "  x {:.2f} to {:.2f} m, y {:.2f} to {:.2f} m; {:.1f} kB a node\n",
      file.string(), map.nodes.size(), json["positions"].get<std::size_t>(),
      json["lines_median"].get<double>(), json["low_m"][0].get<double>(),
      json["high_m"][0].get<double>(), json["low_m"][1].get<double>(),
      json["high_m"][1].get<double>(), 1e-3 * json["bytes_per_node"].get<double>());
  if (const auto empty = json["nodes_without_lines"].get<std::size_t>(); empty > 0) {
    text += fmt::format("  {} nodes without lines\n", empty);
  }
  if (const auto corners = json["corners_mean"].get<double>(); corners > 0) {
    text += fmt::format("  {:.0f} corners each (mean)\n", corners);
  }
  session.result(json, text);
}

TopologicalMap recorded_map(const MakeMapOptions& options, Session& session) {
  if (!options.views.world.empty()) {
    ExperimentSettings settings;
    settings.map_spacing_m = options.spacing_m;
    settings.map_headings = options.headings;
    return SimulatedRobot(options.views, settings, session).record_map(options.drive);
  }
  const NamedViews recorded = read_recorded(options.views, session);
  const std::string place =
      options.views.features.empty() ? options.views.poses : options.views.features;
  return {nodes_of(recorded, place)};
}

void make(const MakeMapOptions& options, const CLI::App& verb, Session& session) {
  check(options.views, verb);
  if (options.views.world.empty()) {
    constexpr std::array of_robot{"--spacing-m", "--headings", "--drive"};
    refuse_options(verb, of_robot, "no robot is simulated");
  }
  if (options.output.empty() == options.extend.empty()) {
    throw Error("map make", options.output.empty() ? "no map is named" : "two maps are named",
                "give -o for a new map, or --extend for one that there is");
  }
  if (!options.views.left.empty() && options.views.poses.empty()) {
    throw Error("map make", "the poses of the images are not given", "give --poses");
  }
  if (!options.extend.empty()) {
    const TopologicalMap before = read_map(options.extend);
    const TopologicalMap map = recorded_map(options, session);
    for (const MapNode& node : map.nodes) {
      if (node.view.rig) check_same_rig(before, *node.view.rig, options.extend);
    }
    extend_map(options.extend, map.nodes);
    report(options.extend, session);
    return;
  }
  for (const std::string& input :
       {options.views.features, options.views.poses, options.views.sources.file}) {
    if (!input.empty()) check_output_is_not_input({input}, options.output);
  }
  write_map(options.output, recorded_map(options, session));
  report(options.output, session);
}

}  // namespace

void add_map(CLI::App& app, Session& session) {
  CLI::App* verb = app.add_subcommand("map", "record topological maps and inspect them");
  verb->require_subcommand(1);
  verb->footer("Example:\n  vernier map make --world workshop -o workshop.map");

  auto o = std::make_shared<MakeMapOptions>();
  CLI::App* maker = add_verb(
      *verb, session, "make",
      "record a topological map: views along a route, of a simulated robot, a file or images",
      "vernier map make --world workshop -o workshop.map\n"
      "  vernier map make --left 'left*.png' --right 'right*.png' --rig rig.json --poses poses.csv "
      "-o rooms.map\n"
      "  vernier map make --features more.jsonl --extend rooms.map");
  add_view_options(*maker, o->views);
  maker->add_option("--spacing-m", o->spacing_m, "distance of nodes along the simulated route")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  maker
      ->add_option("--headings", o->headings,
                   "views all around at each simulated node; 0: one, along the route")
      ->check(CLI::Range(0, 360))
      ->capture_default_str();
  maker->add_option("--drive", o->drive, "number of the simulated drive; every one has its errors")
      ->check(CLI::Range(0u, 1'000'000'000u))
      ->capture_default_str();
  maker->add_option("-o,--output", o->output, "map file");
  maker->add_option("--extend", o->extend, "map file to which the views are added");
  check_files_written(*maker, {"--output", "--extend"});
  maker->callback(
      [o, maker, &session] { session.action = [=, &session] { make(*o, *maker, session); }; });

  auto name = std::make_shared<std::string>();
  CLI::App* info = add_verb(*verb, session, "info", "print nodes, lines, extent and size of a map",
                            "vernier map info workshop.map");
  info->add_option("map", *name, "map file")->required();
  info->callback([name, &session] { session.action = [=, &session] { report(*name, session); }; });
}

}  // namespace vernier::cli
