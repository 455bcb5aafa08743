// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/methods/program_localiser.h"

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/answering_program.h"
#include "calib/base/json_node.h"
#include "calib/base/program_run.h"
#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "localise/topological_map.h"
#include "localise/views/view_json.h"

namespace vernier::localise::internal {

using vernier::internal::AnsweringProgram;
using vernier::internal::in_quotes;
using vernier::internal::JsonNode;

namespace {

constexpr int protocol_version = 2;
/// To read a map, in addition to the time limit of a query; for each node.
constexpr double start_s = 10, node_s = 0.05;

/// The conversation's first lines: what there is, then the nodes.
std::string map_lines(const TopologicalMap& map) {
  std::string lines =
      Json{{"vernier_localiser", protocol_version}, {"nodes", map.nodes.size()}}.dump() + "\n";
  for (std::size_t i = 0; i < map.nodes.size(); ++i) {
    Json node{{"node", i}, {"pose", pose_json(map.nodes[i].pose)}};
    node.update(view_json(map.nodes[i].view));
    lines += node.dump() + "\n";
  }
  return lines;
}

LocalisationStatus parse_status(const JsonNode& node) {
  const std::string word = node.text();
  for (const auto status : {LocalisationStatus::answered, LocalisationStatus::unsure,
                            LocalisationStatus::too_few_lines, LocalisationStatus::too_few_corners,
                            LocalisationStatus::tie, LocalisationStatus::no_match}) {
    if (word == name(status)) return status;
  }
  throw Error(node.place(), in_quotes(word) + " is no status",
              "use answered, unsure, too_few_lines, too_few_corners, tie or no_match");
}

AnsweringProgram make_program(const TopologicalMap& map, const LocaliserOptions& options) {
  std::vector<std::string> words =
      vernier::internal::command_words(options.command, "localiser command");
  if (words.empty()) {
    throw Error("localiser program", "has no command", "name the program that answers");
  }
  const double limit_s =
      options.time_limit_s + start_s + node_s * static_cast<double>(map.nodes.size());
  return {std::move(words),
          {[&map] { return map_lines(map); }, "the map", limit_s},
          options.time_limit_s};
}

double parse_number(const JsonNode& node, const char* key) {
  return node.has(key) ? node.at(key).number() : 0;
}

}  // namespace

LocalisationAnswer parse_answer(const JsonNode& node, const TopologicalMap& map) {
  LocalisationAnswer answer;
  answer.status = parse_status(node.at("status"));
  const bool has_pose = answer.status == LocalisationStatus::answered || node.has("pose");
  if (has_pose) answer.pose = parse_pose(node.at("pose"));
  if (node.has("node") && !node.at("node").json().is_null()) {
    answer.node = node.at("node").integer();
    if (answer.node < -1 || answer.node >= static_cast<int>(map.nodes.size())) {
      throw Error(node.at("node").place(), "is no node of the map", "use -1 for none");
    }
  }
  answer.score = parse_number(node, "score");
  answer.runner_up = parse_number(node, "runner_up");
  answer.probability = parse_number(node, "probability");
  if (!(answer.probability >= 0 && answer.probability <= 1)) {
    throw Error(node.at("probability").place(), "is not from 0 to 1", "leave it out if unknown");
  }
  answer.next_turn_rad = parse_number(node, "next_turn_rad");
  // Without a best guess there is nothing to be unsure of.
  if (answer.status == LocalisationStatus::unsure && !has_pose) {
    answer.status = LocalisationStatus::no_match;
  }
  return answer;
}

ProgramLocaliser::ProgramLocaliser(const TopologicalMap& map, const LocaliserOptions& options)
    : map_(map), program_(make_program(map, options)) {}

LocalisationAnswer ProgramLocaliser::localise(const PlaceView& query) const {
  const Look look{query, 0};
  return localise_looks({&look, 1});
}

LocalisationAnswer ProgramLocaliser::localise_looks(std::span<const Look> looks) const {
  if (looks.empty()) throw Error("looks", "there are none", "give at least one");
  LocalisationAnswer answer;
  // The system counts a program that still runs by the ticks of its scheduler: what it had not
  // counted at an answer counts for the next one.
  const auto question = [&] {
    if (!counted_cpu_s_) counted_cpu_s_ = program_.cpu_s();
    return Json{{"looks", looks_json(looks)}};
  };
  const auto take = [&](const JsonNode& said) { answer = parse_answer(said, map_); };
  if (program_.ask(question, take)) {
    const double now_s = program_.cpu_s();
    answer.program_cpu_ms = 1e3 * (now_s - *counted_cpu_s_);
    counted_cpu_s_ = now_s;
    return answer;
  }
  counted_cpu_s_.reset();
  LocalisationAnswer failed;
  failed.status = LocalisationStatus::failed;
  failed.failure = program_.failure();
  return failed;
}

}  // namespace vernier::localise::internal
