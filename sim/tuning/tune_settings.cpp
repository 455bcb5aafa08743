// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/tuning/tune_settings.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <map>
#include <set>
#include <string_view>

#include "calib/base/shown_text.h"
#include "calib/base/toml_reader.h"
#include "calib/base/toml_writer.h"
#include "calib/error.h"
#include "sim/study/settings_reader.h"
#include "sim/study/study_file.h"
#include "sim/study/system_kind.h"
#include "sim/study/system_reader.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

constexpr std::uint64_t last_seed = std::numeric_limits<std::int64_t>::max();
constexpr std::string_view searched_world = "world.file", searched_seed = "study.seed";

bool is_condition(const std::string& key, const TuneSettings& settings) {
  return key == searched_world || key == searched_seed ||
         std::find(settings.conditions.begin(), settings.conditions.end(), key) !=
             settings.conditions.end();
}

class TuneReader : private SettingsReader {
 public:
  TuneReader(const std::string& place, const StudyFile& study)
      : SettingsReader(place), study_(study) {}

  TuneSettings read(const toml::table& root) const {
    if (!root.contains("tune")) {
      throw Error(place(), "has no [tune]",
                  "add it, with confirm_worlds = [\"…\"], worlds that are not searched");
    }
    const toml::table& table = *section(root, "tune");
    check_keys(table,
               {"objective", "indifference", "error_rate", "conditions", "confirm_worlds",
                "confirm_seed", "confirm_trials"},
               "[tune]");
    refuse_other_studies(root);
    TuneSettings settings;
    if (const auto* node = table.get("objective")) {
      settings.objective = word(*node, "tune.objective", objective_named);
    }
    if (const auto* node = table.get("indifference")) {
      settings.race.indifference = number_in(*node, "tune.indifference", 0, 0.5);
    }
    if (const auto* node = table.get("error_rate")) {
      settings.race.error_rate = number_in(*node, "tune.error_rate", 1e-6, 0.4);
    }
    if (const auto* node = table.get("conditions")) read_conditions(*node, settings);
    refuse_searched_limits(root, settings);
    read_worlds(required(table, "confirm_worlds", "[tune]"), settings);
    read_seed(table, settings);
    settings.confirm_trials = study_.trials;
    if (const auto* node = table.get("confirm_trials")) read_trials(*node, settings);
    return settings;
  }

 private:
  void refuse_other_studies(const toml::table& root) const {
    if (const auto* node = root.get("one_at_a_time")) {
      fail(*node, "a race is run over a [sweep]", "leave [one_at_a_time] out");
    }
    if (!system_of(study_).uses("world")) {
      fail(*root.get("tune"),
           fmt::format("a race confirms on other worlds, and {} has none", system_of(study_).noun),
           "compare its cells by vernier study");
    }
    const toml::table& own = *section(root, "study");
    if (const auto* node = own.get("interval_width")) {
      fail(*node, "a race decides itself how far a cell goes", "leave study.interval_width out");
    }
  }

  /// The loosest limit would win.
  void refuse_searched_limits(const toml::table& root, const TuneSettings& settings) const {
    for (const std::string& key : study_.sweep_keys) {
      if (!applies_on_reading(key) || is_condition(key, settings)) continue;
      fail(*section(root, "sweep")->get(key), "a race over " + key + " is won by the loosest",
           "set it in [system], or name it in tune.conditions");
    }
  }

  void read_conditions(const toml::node& node, TuneSettings& settings) const {
    for (const toml::node& one : list(node, "tune.conditions")) {
      const std::string key = text(one, "tune.conditions");
      const auto& swept = study_.sweep_keys;
      if (std::find(swept.begin(), swept.end(), key) == swept.end()) {
        fail(one, "tune.conditions: " + in_quotes(key) + " is not swept",
             "name a key of [sweep], such as \"sources.calibration\"");
      }
      auto& conditions = settings.conditions;
      if (std::find(conditions.begin(), conditions.end(), key) != conditions.end()) {
        fail(one, "tune.conditions lists " + in_quotes(key) + " twice", "remove one");
      }
      conditions.push_back(key);
    }
  }

  void read_worlds(const toml::node& node, TuneSettings& settings) const {
    const std::vector<std::string> searched = worlds_of(study_);
    for (const toml::node& one : list(node, "tune.confirm_worlds")) {
      const std::string world = file_name(one, "a name in tune.confirm_worlds");
      if (std::find(searched.begin(), searched.end(), world) != searched.end()) {
        fail(one, "tune.confirm_worlds: " + in_quotes(world) + " is searched",
             "name worlds that the study does not use");
      }
      auto& worlds = settings.confirm_worlds;
      if (std::find(worlds.begin(), worlds.end(), world) != worlds.end()) {
        fail(one, "tune.confirm_worlds lists " + in_quotes(world) + " twice", "remove one");
      }
      worlds.push_back(world);
    }
    if (settings.confirm_worlds.empty()) {
      fail(node, "tune.confirm_worlds is empty", "name at least one world that is not searched");
    }
  }

  void read_seed(const toml::table& table, TuneSettings& settings) const {
    std::set<std::uint64_t> searched;
    for (const StudyCell& cell : study_.cells) searched.insert(cell.experiment.seed);
    const auto* node = table.get("confirm_seed");
    if (!node) {
      settings.confirm_seed = *searched.rbegin() < last_seed ? *searched.rbegin() + 1 : 0;
      while (searched.count(settings.confirm_seed) > 0) ++settings.confirm_seed;
      return;
    }
    const std::int64_t seed = integer(*node, "tune.confirm_seed");
    if (seed < 0) fail(*node, "tune.confirm_seed is negative", "use 0 or more");
    settings.confirm_seed = static_cast<std::uint64_t>(seed);
    if (searched.count(settings.confirm_seed) > 0) {
      fail(*node, fmt::format("tune.confirm_seed = {} is searched", seed),
           "use a seed that the study does not use");
    }
  }

  void read_trials(const toml::node& node, TuneSettings& settings) const {
    constexpr std::int64_t most = 10'000'000;
    const std::int64_t trials = integer(node, "tune.confirm_trials");
    if (trials < 1 || trials > most) {
      fail(node, fmt::format("tune.confirm_trials = {} is out of range", trials),
           fmt::format("use 1 to {}", most));
    }
    settings.confirm_trials = static_cast<int>(trials);
  }

  const StudyFile& study_;
};

/// A list of texts as TOML.
toml::array texts(const std::vector<std::string>& from) {
  toml::array list;
  for (const std::string& one : from) list.push_back(one);
  return list;
}

}  // namespace

TuneSettings parse_tune(const std::string& text, const std::string& place, const StudyFile& study) {
  return TuneReader(place, study).read(parse_toml(text, place));
}

std::vector<Candidate> candidates_of(const StudyFile& study,
                                     const TuneSettings& settings,
                                     const std::string& place) {
  std::vector<Candidate> candidates;
  std::map<std::string, std::size_t> known;  // by label
  for (std::size_t cell = 0; cell < study.cells.size(); ++cell) {
    Candidate one;
    for (const auto& [key, value] : study.cells[cell].swept) {
      if (is_condition(key, settings)) continue;
      one.label += (one.label.empty() ? "" : ", ") + key + " = " + value;
      one.values.emplace_back(key, value);
    }
    const auto [place_of, is_new] = known.emplace(one.label, candidates.size());
    if (is_new) candidates.push_back(std::move(one));
    candidates[place_of->second].cells.push_back(static_cast<int>(cell));
  }
  if (candidates.size() < 2) {
    throw Error(place, "has nothing to race: one candidate",
                "list two or more values of a setting in [sweep]; world.file, study.seed and "
                "tune.conditions make no candidates");
  }
  return candidates;
}

std::string confirmation_text(const std::string& text,
                              const std::string& place,
                              const Candidate& candidate,
                              const TuneSettings& settings) {
  toml::table study = parse_toml(text, place);
  toml::table sweep, searched = *study.get("sweep")->as_table();
  study.erase("sweep");
  study.erase("tune");
  for (const auto& [key, node] : searched) {
    const std::string swept(key.str());
    const auto value = std::find_if(candidate.values.begin(), candidate.values.end(),
                                    [&](const auto& one) { return one.first == swept; });
    if (value == candidate.values.end()) {
      if (swept != searched_world && swept != searched_seed) sweep.insert(swept, *node.as_array());
      continue;
    }
    for (const toml::node& one : *node.as_array()) {
      if (shown_value(one) == value->second) set_swept(study, swept, one);
    }
  }
  set_swept(study, std::string(searched_seed),
            toml::value<std::int64_t>(static_cast<std::int64_t>(settings.confirm_seed)));
  set_swept(study, "study.trials", toml::value<std::int64_t>(settings.confirm_trials));
  set_swept(study, std::string(searched_world),
            toml::value<std::string>(settings.confirm_worlds[0]));
  if (settings.confirm_worlds.size() > 1) {
    sweep.insert(std::string(searched_world), texts(settings.confirm_worlds));
  }
  if (!sweep.empty()) study.insert("sweep", std::move(sweep));
  return "# Made by vernier tune: confirms " + candidate.label + "\n" + toml_text(study);
}

}  // namespace vernier::sim::internal
