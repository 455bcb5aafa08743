// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/methods/program_localiser.h"

#include <fmt/format.h>

#include <cstddef>
#include <nlohmann/json.hpp>

#include "calib/base/json_node.h"
#include "calib/base/json_reader.h"
#include "calib/base/program_conversation.h"
#include "calib/base/program_run.h"
#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "localise/topological_map.h"
#include "localise/views/view_json.h"

namespace vernier::localise::internal {

using vernier::internal::in_quotes;
using vernier::internal::JsonNode;
using vernier::internal::ProgramConversation;

namespace {

constexpr int most_failures = 3;
constexpr int protocol_version = 1;
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

/// What went wrong, with what the program itself says of it.
std::string fault(ProgramConversation::Outcome outcome,
                  double limit_s,
                  const ProgramConversation& program) {
  using Outcome = ProgramConversation::Outcome;
  std::string what;
  if (outcome == Outcome::ended) what = "has ended without an answer";
  if (outcome == Outcome::timed_out) what = fmt::format("gives no answer within {:g} s", limit_s);
  if (outcome == Outcome::too_long) what = "answers with a line of more than 16 MB";
  const std::string complaint = program.last_complaint();
  return complaint.empty() ? what : what + " (" + complaint + ")";
}

double parse_number(const JsonNode& node, const char* key) {
  return node.has(key) ? node.at(key).number() : 0;
}

}  // namespace

LocalisationAnswer parse_answer(std::string_view line, const TopologicalMap& map) {
  const Json json = vernier::internal::parse_json(line, "answer");
  const JsonNode node(json, "answer:");
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
    : map_(map),
      command_(options.command),
      words_(vernier::internal::command_words(options.command, "localiser command")),
      time_limit_s_(options.time_limit_s) {
  if (words_.empty()) {
    throw Error("localiser program", "has no command", "name the program that answers");
  }
  start();
}

ProgramLocaliser::~ProgramLocaliser() = default;

/// Starts the program and tells it the map; without program_ afterwards it did not get ready, and
/// failure_ says why.
void ProgramLocaliser::start() const {
  auto program = std::make_unique<Conversation>(words_);
  std::string answer;
  const double limit = time_limit_s_ + start_s + node_s * static_cast<double>(map_.nodes.size());
  const auto outcome = program->ask(map_lines(map_), limit, answer);
  failure_ = fault(outcome, limit, *program);
  if (outcome != Conversation::Outcome::line) return;
  failure_ = "answers the map with " + in_quotes(answer) + " instead of {\"ready\": true}";
  try {
    const Json json = vernier::internal::parse_json(answer, "answer");
    if (json.is_object() && json.contains("ready") && json["ready"] == true) {
      program_ = std::move(program);
    }
  } catch (const Error&) {  // no JSON
  }
}

LocalisationAnswer ProgramLocaliser::localise(const PlaceView& query) const {
  const Look look{query, 0};
  return localise_looks({&look, 1});
}

LocalisationAnswer ProgramLocaliser::localise_looks(std::span<const Look> looks) const {
  if (looks.empty()) throw Error("looks", "there are none", "give at least one");
  LocalisationAnswer failed;
  failed.status = LocalisationStatus::failed;
  failed.failure = failure_;
  if (failures_ >= most_failures) return failed;
  ++failures_;
  if (!program_) start();
  failed.failure = failure_;
  if (!program_) return failed;
  const double before = program_->cpu_s();
  std::string line;
  const auto outcome =
      program_->ask(Json{{"looks", looks_json(looks)}}.dump() + "\n", time_limit_s_, line);
  failure_ = fault(outcome, time_limit_s_, *program_);
  if (outcome == Conversation::Outcome::line) {
    try {
      LocalisationAnswer answer = parse_answer(line, map_);
      answer.program_cpu_ms = 1e3 * (program_->cpu_s() - before);
      failures_ = 0;
      return answer;
    } catch (const Error& error) {
      failure_ = "answers nonsense: " + error.place() + " " + error.fault();
    }
  }
  program_.reset();  // what it prints later would be taken for the next answer
  failed.failure = failure_;
  return failed;
}

}  // namespace vernier::localise::internal
