// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/localiser.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/shown_text.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "cli/localisation/localised_queries.h"
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

struct LocaliseArguments {
  std::string map, method = "lines", protocol = "path", output;
  ViewOptions views;
  LocaliserOptions localiser;
  std::string stages = name(LocaliserStages{});
  std::uint32_t queries = 20;
  int looks = 1;
};

double thread_cpu_ms() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// Whether the method compares views in the images of two cameras.
bool needs_pair(const std::string& method) { return method == "lines" || method == "corners"; }

/// Throws Error for a view of one camera with depths, which such a method cannot use.
void check_pair(const PlaceView& view, const LocaliseArguments& options, const std::string& place) {
  if (!needs_pair(options.method) || !view.rig || view.rig->cameras.size() >= 2) return;
  throw Error(place,
              "is of one camera with depths, and --method " + options.method +
                  " compares the images of two",
              "give --method pgh");
}

/// Throws Error for a view that cannot be compared with a map's.
void check_cameras(const PlaceView& view,
                   const TopologicalMap& map,
                   const LocaliseArguments& options,
                   const std::string& name) {
  if (view.rig) {
    check_pair(view, options, options.views.features + ": " + name);
    check_same_rig(map, *view.rig, options.map);
  } else if (needs_pair(options.method)) {
    throw Error(options.views.features, name + " has no cameras",
                "give --rig, or \"cameras\" with each view");
  }
}

/// Whether two views hold the same lines, or corners where there are none, as far as a map's file
/// keeps them.
bool is_same_view(const PlaceView& a, const PlaceView& b) {
  constexpr double least_m = 1e-5, least_px = 1e-3;
  if (a.lines.empty() && a.corners.empty()) return false;
  const auto is_same_line = [&](const PlaceLine& one, const PlaceLine& other) {
    return (one.a_m - other.a_m).norm() < least_m && (one.b_m - other.b_m).norm() < least_m;
  };
  const auto is_same_corner = [&](const StereoCorner& one, const StereoCorner& other) {
    return (one.left_px - other.left_px).norm() < least_px;
  };
  return std::equal(a.lines.begin(), a.lines.end(), b.lines.begin(), b.lines.end(), is_same_line) &&
         (!a.lines.empty() || std::equal(a.corners.begin(), a.corners.end(), b.corners.begin(),
                                         b.corners.end(), is_same_corner));
}

/// Says how many queries are views that the map was made of.
void tell_own_views(const std::vector<RecordedLooks>& queries,
                    const TopologicalMap& map,
                    Session& session) {
  const auto own = std::count_if(queries.begin(), queries.end(), [&](const RecordedLooks& query) {
    return std::any_of(map.nodes.begin(), map.nodes.end(), [&](const MapNode& node) {
      return is_same_view(query.looks[0].view, node.view);
    });
  });
  if (own == 0) return;
  session.warn(
      fmt::format("{} of {} queries {} the map was made of: their answers do not tell "
                  "how well it localises",
                  own, queries.size(), own == 1 ? "is a view that" : "are views that"));
}

std::vector<LocalisedQuery> recorded_queries(const LocaliseArguments& options,
                                             const TopologicalMap& map,
                                             const Localiser& localiser,
                                             Session& session) {
  const NamedViews recorded = read_recorded(options.views, session);
  const bool uses_looks = uses_option(options.method, "looks");
  const auto further = std::count_if(recorded.views.begin(), recorded.views.end(),
                                     [](const RecordedLooks& v) { return v.looks.size() > 1; });
  if (!uses_looks && further > 0) {
    session.warn(fmt::format("--method {} uses the first look alone, and {} {} more",
                             options.method, counted(further, "view"),
                             further == 1 ? "has" : "have"));
  }
  std::vector<LocalisedQuery> queries;
  for (std::size_t i = 0; i < recorded.views.size(); ++i) {
    const RecordedLooks& seen = recorded.views[i];
    const PlaceView& first = seen.looks[0].view;
    for (std::size_t k = 0; k < (uses_looks ? seen.looks.size() : 1); ++k) {
      const std::string name = recorded.names[i] + (k > 0 ? fmt::format(", look {}", k + 1) : "");
      check_cameras(seen.looks[k].view, map, options, name);
    }
    LocalisedQuery query;
    query.name = recorded.names[i];
    query.truth = seen.pose;
    query.lines = static_cast<int>(first.lines.size());
    query.looks = uses_looks ? static_cast<int>(seen.looks.size()) : 1;
    const double before = thread_cpu_ms();
    query.answer = localiser.localise_looks(seen.looks);
    query.cpu_ms = thread_cpu_ms() - before + query.answer.program_cpu_ms;
    queries.push_back(std::move(query));
  }
  tell_own_views(recorded.views, map, session);
  return queries;
}

std::vector<LocalisedQuery> simulated_queries(const LocaliseArguments& options,
                                              const TopologicalMap& map,
                                              const Localiser& localiser,
                                              Session& session) {
  ExperimentSettings settings;
  settings.protocol = query_protocol(options.protocol);
  settings.looks = options.looks;
  settings.method = options.method;
  const SimulatedRobot robot(options.views, settings, session);
  check_same_rig(map, robot.rig().rig, options.map);
  std::vector<LocalisedQuery> queries;
  constexpr std::uint32_t few = 100;
  std::optional<Progress> progress;
  if (options.queries > few) progress.emplace(session, "queries");
  for (std::uint32_t i = 0; i < options.queries; ++i) {
    const auto [trial, answer] = robot.run_query(i, map, localiser);
    LocalisedQuery query;
    query.name = "query " + std::to_string(i);
    query.truth = trial.truth;
    query.answer = answer;
    query.lines = trial.lines;
    query.looks = trial.looks;
    query.cpu_ms = trial.cpu_ms;
    queries.push_back(std::move(query));
    if (progress) progress->update(static_cast<int>(i + 1), static_cast<int>(options.queries));
  }
  return queries;
}

/// Refuses options that the method does not use.
void check_options_of_method(const LocaliseArguments& options, const CLI::App& verb) {
  constexpr std::array<std::pair<const char*, const char*>, 11> known{
      {{"--looks", "looks"},
       {"--ranker", "ranker"},
       {"--candidates", "candidates"},
       {"--max-error-rate", "max_error_rate"},
       {"--look-error-rate", "look_error_rate"},
       {"--off-map", "off_map"},
       {"--repeats", "repeats"},
       {"--stages", "stages"},
       {"--min-corners", "min_corners"},
       {"--command", "command"},
       {"--time-limit-s", "time_limit_s"}}};
  for (const auto& [option, name] : known) {
    if (uses_option(options.method, name, options.localiser)) continue;
    if (uses_option(options.method, name)) {
      refuse_options(verb, std::array{option}, "it has no effect without the stage compare",
                     "leave it out, or add the stage");
    }
    refuse_options(verb, std::array{option}, "it has no effect on --method " + options.method,
                   "leave it out, or choose another method");
  }
}

void check(const LocaliseArguments& options, const CLI::App& verb) {
  check(options.views, verb);
  if (options.views.world.empty()) {
    constexpr std::array of_robot{"--protocol", "-n", "--looks"};
    refuse_options(verb, of_robot, "no robot is simulated");
  }
  if (options.method == "program" && options.localiser.command.empty()) {
    throw Error("localise", "--method program needs the program", "give --command");
  }
  check_options_of_method(options, verb);
  if (options.output.empty()) return;
  check_output_is_not_input({options.map}, options.output);
  for (const std::string& input : {options.views.features, options.views.poses, options.views.rig,
                                   options.views.world, options.views.sources.file}) {
    if (!input.empty()) check_output_is_not_input({input}, options.output);
  }
}

void check_corners(const TopologicalMap& map, const LocaliseArguments& options) {
  if (options.method != "corners" || map.nodes.empty()) return;
  for (const MapNode& node : map.nodes) {
    if (!node.view.corners.empty()) return;
  }
  throw Error(options.map, "has no corners, which --method corners looks for",
              "make it with map make --corners");
}

void run(LocaliseArguments options, const CLI::App& verb, Session& session) {
  options.localiser.stages = localiser_stages(options.stages);
  check(options, verb);
  options.views.corners = options.views.corners || needs_corners(options.method, options.localiser);
  const TopologicalMap map = read_map(options.map);
  for (const MapNode& node : map.nodes) check_pair(node.view, options, options.map);
  check_corners(map, options);
  if (!can_be_sure(options.method, options.localiser)) {
    throw Error("--stages " + options.stages,
                "states no probability, so that every answer would be unsure",
                "also give --max-error-rate 1, or add the stage compare");
  }
  const auto localiser = make_localiser(options.method, map, options.localiser);
  const std::vector<LocalisedQuery> queries =
      options.views.world.empty() ? recorded_queries(options, map, *localiser, session)
                                  : simulated_queries(options, map, *localiser, session);
  if (!options.output.empty()) write_atomically(options.output, queries_csv(queries));
  check_answers(queries, options.localiser.off_map, session);
  Json json{{"map", options.map}, {"method", options.method}};
  json.update(queries_json(queries));
  json["doubts"] = session.trust_warnings();
  session.result(json, queries_table(queries));
}

}  // namespace

void add_localise(CLI::App& app, Session& session) {
  auto o = std::make_shared<LocaliseArguments>();
  CLI::App* verb = add_verb(
      app, session, "localise", "find where views were taken on a topological map",
      "vernier map make --world workshop -o workshop.map\n"
      "  vernier localise workshop.map --world workshop -n 20\n"
      "  vernier localise rooms.map --left 'left*.png' --right 'right*.png' --rig rig.json\n"
      "  vernier localise rooms.map --features views.jsonl --rig rig.json -o answers.csv");
  verb->add_option("map", o->map, "map file")->required();
  add_view_options(*verb, o->views);
  verb->add_option("--protocol", o->protocol,
                   "where the simulated robot asks: near_path, path, anywhere or free")
      ->capture_default_str();
  verb->add_option("-n", o->queries, "number of simulated queries")
      ->check(CLI::Range(1u, 1'000'000u))
      ->capture_default_str();
  verb->add_option("--looks", o->looks,
                   "views from a position at most, the further ones where it is unsure")
      ->check(CLI::Range(1, 12))
      ->capture_default_str();
  verb->add_option("--method", o->method, alternatives(localiser_names()))->capture_default_str();
  verb->add_option("--ranker", o->localiser.ranker, "of lines: view, pgh or pgh_aggregate")
      ->capture_default_str();
  verb->add_option("--candidates", o->localiser.candidates, "best-ranked poses to verify")
      ->capture_default_str();
  verb->add_option("--max-error-rate", o->localiser.max_error_rate,
                   "of lines: unsure where an error is more probable; 1: an answer is never unsure")
      ->capture_default_str();
  verb->add_option("--look-error-rate", o->localiser.look_error_rate,
                   "of lines: asks for a further look where an error is more probable, "
                   "at most --max-error-rate (default: the same)");
  verb->add_option("--off-map", o->localiser.off_map,
                   "of lines: probability that the robot is where the map holds nothing; 0: never")
      ->capture_default_str();
  verb->add_option(
          "--repeats", o->localiser.repeats,
          "of lines: probability, before the map's views are compared, that places which look "
          "alike are equal")
      ->capture_default_str();
  verb->add_option("--stages", o->stages, "of lines: those that run, or none")
      ->capture_default_str();
  verb->add_option("--min-corners", o->localiser.min_corners,
                   "of corners: so many must agree for an answer")
      ->check(CLI::Range(4, 10'000))
      ->capture_default_str();
  verb->add_option("--command", o->localiser.command,
                   "of program: a program of your own and its arguments (docs/own-localiser.md)");
  verb->add_option("--time-limit-s", o->localiser.time_limit_s, "of program, for a query")
      ->check(finite_and_positive)
      ->capture_default_str();
  verb->add_option("-o,--output", o->output, "answers, one line a query");
  check_files_written(*verb, {"--output"});
  verb->callback(
      [o, verb, &session] { session.action = [=, &session] { run(*o, *verb, session); }; });
}

}  // namespace vernier::cli
