// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/study_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/fingerprint.h"
#include "calib/base/json_node.h"
#include "calib/base/json_reader.h"
#include "calib/base/program_run.h"
#include "calib/error.h"
#include "calib/interval.h"
#include "localise/localiser.h"
#include "localise/pgh.h"
#include "sim/experiment.h"
#include "sim/sources.h"
#include "sim/study/ceiling.h"
#include "sim/study/reconstruct.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_store.h"
#include "sim/study/system_kind.h"
#include "sim/study/system_reader.h"
#include "sim/study/told_settings.h"
#include "sim/told/fresh_calibrations.h"
#include "sim/visibility.h"

namespace vernier::sim::internal {

using namespace vernier::internal;
using namespace localise;

namespace {

/// Of ceilings: 3 since the protocol's density counts.
constexpr int ceiling_version = 3;

/// Block size that is not part of a cell's key: all stores had it before sizes could differ.
constexpr int usual_block = 50;

constexpr const char* source_files = "sources.files";
constexpr const char* localiser_files = "localiser.files";
constexpr const char* system_files = "system.files";

/// "1:0.5:0 2:1:1 " as query, `right` and `unaliased`; empty for other text.
std::vector<std::pair<int, QueryCeiling>> parsed_ceilings(const std::string& text) {
  std::vector<std::pair<int, QueryCeiling>> parsed;
  std::istringstream in(text);
  int query = 0;
  QueryCeiling one;
  char first = 0, second = 0;
  while (in >> query >> first >> one.right >> second >> one.unaliased && first == ':' &&
         second == ':') {
    parsed.emplace_back(query, one);
  }
  if (!in.eof()) parsed.clear();
  return parsed;
}

/// Those of the method's histograms that differ from the default, which older stores have no keys
/// of.
std::map<std::string, std::string> histogram_settings(const ExperimentSettings& s) {
  const LocaliserOptions usual;
  const bool of_image = uses_image_histograms(s.method);
  const PghOptions& own = of_image ? s.localiser.image_histograms : s.localiser.histograms;
  const PghOptions& other = of_image ? usual.image_histograms : usual.histograms;
  std::map<std::string, std::string> changed;
  const auto add = [&](const char* key, const auto& value, const auto& default_value) {
    if (value != default_value)
      changed[fmt::format("histograms.{}", key)] = fmt::format("{}", value);
  };
  constexpr double degree = std::numbers::pi / 180;
  add("type", name(own.type), name(other.type));
  add("blur", name(own.blur), name(other.blur));
  add("angle_bins", own.angle_bins, other.angle_bins);
  add("distance_bins", own.distance_bins, other.distance_bins);
  add("height_bands", own.height_bands, other.height_bands);
  add("max_lines", own.max_lines, other.max_lines);
  add("max_distance", own.max_distance, other.max_distance);
  add("angle_sigma_deg", own.angle_sigma_rad / degree, other.angle_sigma_rad / degree);
  add("distance_sigma", own.distance_sigma, other.distance_sigma);
  return changed;
}

/// Settings of sources that have their default and that older stores have no keys of.
std::set<std::string> newer_at_default(const SourceSettings& sources) {
  const SourceSettings usual;
  std::set<std::string> names;
  for (const SourceParameter& p : source_parameters()) {
    if (p.is_newer && sources.*p.value == usual.*p.value) {
      names.insert(fmt::format("sources.{}", p.name));
    }
  }
  return names;
}

/// The content of the files that are words of a command: a program that has changed is another one.
std::string files_named_in(const std::string& command) {
  std::string content;
  for (const std::string& word : command_words(command, "command")) {
    std::error_code unknown;
    constexpr std::uintmax_t most_bytes = 10'000'000;
    if (!std::filesystem::is_regular_file(word, unknown) ||
        std::filesystem::file_size(word, unknown) > most_bytes) {
      continue;
    }
    content += word;
    content += '\n';
    content += read_whole(word);
  }
  return content;
}

}  // namespace

std::map<std::string, std::string> settings_of(const ExperimentSettings& s) {
  constexpr double degree = std::numbers::pi / 180;
  std::map<std::string, std::string> all;
  for (const SourceParameter& p : source_parameters()) {
    all[fmt::format("sources.{}", p.name)] = fmt::format("{}", s.sources.*p.value);
  }
  const bool common = s.sources.lateral_shift_mode == ShiftMode::common;
  all["sources.lateral_shift_mode"] = common ? "common" : "independent";
  for (const OwnSource& own : s.sources.own) {
    std::string& names = all["sources.own"];
    names += (names.empty() ? "" : ", ") + own.name;
    for (const auto& [option, value] : own.options) {
      all[fmt::format("sources.{}.{}", own.name, option)] = fmt::format("{}", value);
    }
  }
  if (!s.sources.command.empty()) {
    all["sources.command"] = s.sources.command;
    all["sources.time_limit_s"] = fmt::format("{}", s.sources.time_limit_s);
  }
  all["camera.height_m"] = fmt::format("{}", s.mount.height_m);
  all["camera.pitch_deg"] = fmt::format("{}", s.mount.pitch_rad / degree);
  all["map.spacing_m"] = fmt::format("{}", s.map_spacing_m);
  all["map.headings"] = s.map_headings == 0 ? "path" : fmt::format("{}", s.map_headings);
  all["map.rig"] = s.map_rig == MapRig::same ? "same" : "recalibrated";
  all["localiser.method"] = s.method;
  all["localiser.knows_endpoint_sigma"] = s.knows_endpoint_sigma ? "true" : "false";
  if (s.looks != 1) all["localiser.looks"] = fmt::format("{}", s.looks);
  const LocaliserOptions usual;  // older stores have no keys of these
  if (s.localiser.ranker != usual.ranker) all["localiser.ranker"] = s.localiser.ranker;
  if (s.localiser.candidates != usual.candidates) {
    all["localiser.candidates"] = fmt::format("{}", s.localiser.candidates);
  }
  if (s.localiser.max_error_rate != usual.max_error_rate) {
    all["localiser.max_error_rate"] = fmt::format("{}", s.localiser.max_error_rate);
  }
  if (s.localiser.look_error_rate) {
    all["localiser.look_error_rate"] = fmt::format("{}", *s.localiser.look_error_rate);
  }
  if (s.localiser.repeats != usual.repeats) {
    all["localiser.repeats"] = fmt::format("{}", s.localiser.repeats);
  }
  if (s.localiser.off_map != usual.off_map) {
    all["localiser.off_map"] = fmt::format("{}", s.localiser.off_map);
  }
  if (name(s.localiser.stages) != name(usual.stages)) {
    all["localiser.stages"] = name(s.localiser.stages);
  }
  all.merge(histogram_settings(s));
  if (needs_corners(s.method, s.localiser)) {
    all["corners.view_change"] = fmt::format("{}", s.appearance.view_change);
    all["corners.noise"] = fmt::format("{}", s.appearance.noise);
    all["localiser.min_corners"] = fmt::format("{}", s.localiser.min_corners);
  }
  if (s.localiser.corners) all["localiser.corners"] = "true";
  if (s.method == "program") {
    all["localiser.command"] = s.localiser.command;
    all["localiser.time_limit_s"] = fmt::format("{}", s.localiser.time_limit_s);
  }
  all["study.protocol"] = name(s.protocol);
  all["study.seed"] = fmt::format("{}", s.seed);
  return all;
}

std::string cell_key(const Study& study, const StudyCell& cell) {
  nlohmann::ordered_json key{{"results", results_version}};
  if (system_kind(cell.system.name).uses("world")) key["world"] = world_fingerprint_of(study, cell);
  key["rig"] = study.rig_fingerprint;
  if (cell.visibility != VisibilityMethod::exact) key["world.visibility"] = "view_sets";
  if (!cell.told.truth.empty() && !cell.told.calibration) {
    key["told"] = study.told_rigs.at(cell.told.file).fingerprint;
  }
  if (!cell.told.observations.empty()) key["corners"] = study.corners_fingerprint;
  const std::set<std::string> left_out = newer_at_default(cell.experiment.sources);
  std::map<std::string, std::string> settings = cell.settings;
  settings.merge(settings_of(cell.told));  // also those that are not shown, as all stores have them
  for (const auto& [name, value] : settings) {
    if (name == "localiser.knows_endpoint_sigma" || left_out.contains(name)) continue;
    if (!names_a_file(name) && !applies_on_reading(name)) key[name] = value;
  }
  // Older stores had no such setting and this value; their results remain valid.
  const double once_told = std::max(0.1, cell.experiment.sources.endpoint_sigma_px);
  if (const double told = told_endpoint_sigma_px(cell.experiment); told != once_told) {
    key["localiser.told_endpoint_sigma_px"] = told;
  }
  if (study.file.trials_per_block != usual_block) {
    key["study.trials_per_block"] = study.file.trials_per_block;
  }
  if (const std::string command = cell.system.command(); !command.empty()) {
    key[system_files] = fingerprint(files_named_in(command));
  }
  if (const std::string& command = cell.experiment.sources.command; !command.empty()) {
    key[source_files] = fingerprint(files_named_in(command));
  }
  if (!cell.system.is_localiser()) {
    if (const int version = system_kind(cell.system.name).version; version > 0) {
      key["system.version"] = version;
    }
    return key.dump();
  }
  if (cell.experiment.method == "lines") key["localiser.version"] = lines_version;
  if (cell.experiment.method == "program") {
    key[localiser_files] = fingerprint(files_named_in(cell.experiment.localiser.command));
  }
  return key.dump();
}

std::string without_program_files(const std::string& cell_key) {
  nlohmann::ordered_json key = nlohmann::ordered_json::parse(cell_key, nullptr, false);
  if (!key.is_object()) return cell_key;
  key.erase(source_files);
  key.erase(localiser_files);
  key.erase(system_files);
  return key.dump();
}

std::string looks_key(const StudyCell& cell) {
  const ExperimentSettings& s = cell.experiment;
  return fmt::format("{} {} {} {} {} {} {}", s.mount.height_m, s.mount.pitch_rad, s.map_spacing_m,
                     s.map_headings, needs_corners(s.method, s.localiser),
                     static_cast<int>(cell.visibility), cell.world);
}

std::string ceiling_key(const Study& study, const StudyCell& cell) {
  const ExperimentSettings& s = cell.experiment;
  std::string key = fmt::format("ceiling {} {} {} {} {} {} {}", ceiling_version,
                                world_fingerprint_of(study, cell), study.rig_fingerprint,
                                name(s.protocol), s.mount.height_m, s.mount.pitch_rad, s.seed);
  if (s.sources.moved > 0) key += fmt::format(" moved {}", s.sources.moved);  // of that world
  if (cell.visibility != VisibilityMethod::exact) key += " by view sets";
  return key;
}

std::string calibration_key(const Study& study, const StudyCell& cell) {
  constexpr int covariance = 2;  // 2: that of many views is shrunk
  std::string key = fmt::format(
      "calibration {}.{} {} {} {}", results_version, covariance, study.rig_fingerprint,
      cell.told.observations.empty() ? "" : study.corners_fingerprint, cell.experiment.seed);
  for (const auto& [name, value] : settings_of(cell.told)) {
    if (!names_a_file(name)) key += fmt::format(" {}={}", name, value);
  }
  return key;
}

StoreNotes::value_type calibration_note(const std::string& calibration,
                                        const CalibrationRecord& record) {
  const auto number = [](double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
  };
  const nlohmann::ordered_json json{{"calibrations", record.calibrations},
                                    {"failed", record.failed},
                                    {"doubtful", record.doubtful},
                                    {"why_failed", record.why_failed},
                                    {"why_doubtful", record.why_doubtful},
                                    {"range_m", record.range_m},
                                    {"depth_error_m", number(record.depth_error_m)},
                                    {"depth_sd_m", number(record.depth_sd_m)}};
  return {calibration, json.dump()};
}

std::optional<CalibrationRecord> noted_calibrations(const StoreNotes& notes,
                                                    const std::string& calibration) {
  const auto note = notes.find(calibration);
  if (note == notes.end()) return std::nullopt;
  try {
    const nlohmann::ordered_json json = parse_json(note->second, "note");
    const JsonNode of(json, "note:");
    const auto number = [&](const char* key) {
      return of.at(key).json().is_null() ? std::numeric_limits<double>::quiet_NaN()
                                         : of.at(key).number();
    };
    const CalibrationRecord record{of.at("calibrations").integer(), of.at("failed").integer(),
                                   of.at("doubtful").integer(),     of.at("why_failed").text(),
                                   of.at("why_doubtful").text(),    number("range_m"),
                                   number("depth_error_m"),         number("depth_sd_m")};
    const auto counts_some = [&](int count) { return count >= 0 && count <= record.calibrations; };
    if (counts_some(record.failed) && counts_some(record.doubtful)) return record;
  } catch (const Error&) {  // said below
  }
  throw Error("store", "its note of calibrations is damaged",
              "delete the stores of the folder and run the study again");
}

int ceiling_queries(const Study& study, const std::string& ceiling) {
  constexpr std::int64_t enough = 5000;
  std::int64_t trials = 0;
  for (const StudyCell& cell : study.file.cells) {
    if (ceiling_key(study, cell) == ceiling) trials += study.file.trials;
  }
  return static_cast<int>(std::min(trials, enough));
}

StoreNotes::value_type ceiling_part(const std::string& ceiling, const QueryCeilings& of_query) {
  std::string text;
  for (std::size_t i = 0; i < of_query.size(); ++i) {
    if (of_query[i]) {
      text += fmt::format("{}:{}:{:d} ", i, of_query[i]->right, of_query[i]->unaliased);
    }
  }
  return {fmt::format("{} part {}", ceiling, fingerprint(text)), text};
}

QueryCeilings noted_queries(const Study& study,
                            const StoreNotes& notes,
                            const std::string& ceiling) {
  QueryCeilings of_query(static_cast<std::size_t>(ceiling_queries(study, ceiling)));
  const std::string start = ceiling + " part ";
  for (auto note = notes.lower_bound(start);
       note != notes.end() && note->first.rfind(start, 0) == 0; ++note) {
    for (const auto& [query, found] : parsed_ceilings(note->second)) {
      if (query < 0 || query >= static_cast<int>(of_query.size())) continue;
      if (!(found.right >= 0 && found.right <= 1)) continue;
      std::optional<QueryCeiling>& known = of_query[static_cast<std::size_t>(query)];
      if (known && known != found) {
        throw Error(fmt::format("query {} of the world ceiling", query),
                    "two stores disagree on it",
                    "the stores come from different builds or processors; run one again");
      }
      known = found;
    }
  }
  return of_query;
}

std::optional<WorldCeiling> noted_ceiling(const Study& study,
                                          const StoreNotes& notes,
                                          const std::string& ceiling) {
  double unaliased = 0, right = 0;
  const QueryCeilings of_query = noted_queries(study, notes, ceiling);
  for (const std::optional<QueryCeiling>& query : of_query) {  // in order, whichever was done first
    if (!query) return std::nullopt;
    unaliased += query->unaliased;
    right += query->right;
  }
  const auto all = static_cast<double>(of_query.size());
  return WorldCeiling{right / all, unaliased / all, wilson_interval(right, all),
                      wilson_interval(unaliased, all), static_cast<int>(of_query.size())};
}

std::string command_key(const std::string& command) { return "command " + command; }

std::string machine_key(const std::string& machine) { return "machine " + machine; }

}  // namespace vernier::sim::internal
