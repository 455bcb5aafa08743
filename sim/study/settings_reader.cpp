// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/settings_reader.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/program_run.h"
#include "calib/base/shown_text.h"
#include "calib/base/toml_reader.h"
#include "calib/error.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "sim/corner_appearance.h"
#include "sim/experiment.h"
#include "sim/sources.h"
#include "sim/uncertainty_source.h"

namespace vernier::sim::internal {

using namespace localise;
using namespace vernier::internal;

namespace {

constexpr double radians_per_degree = std::numbers::pi / 180;

}  // namespace

void set_swept(toml::table& study, const std::string& key, const toml::node& value) {
  const std::size_t dot = key.find('.');
  const std::string section = key.substr(0, dot), entry = key.substr(dot + 1);
  if (!study.contains(section)) study.insert(section, toml::table{});
  if (toml::table* into = study.get(section)->as_table()) {
    value.visit([&](const auto& v) { into->insert_or_assign(entry, v); });
  }
}

double SettingsReader::number_in(const toml::node& node,
                                 const std::string& what,
                                 double low,
                                 double high) const {
  const double value = number(node, what);
  if (!(value >= low && value <= high)) {
    fail(node, fmt::format("{} = {} is out of range", what, value),
         fmt::format("use {} to {}", low, high));
  }
  return value;
}

void SettingsReader::read_sources(const toml::table& table, SourceSettings& sources) const {
  read_own_sources(table, sources);
  Keys keys{"file", "lateral_shift_mode", "own", "command", "time_limit_s"};
  for (const SourceParameter& parameter : source_parameters()) keys.push_back(parameter.name);
  for (const OwnSource& own : sources.own) {
    keys.push_back(own.name);
    for (const auto& [key, value] : table) {  // a sweep of an option gives such a key
      if (key.str().starts_with(own.name + ".")) keys.push_back(key.str());
    }
  }
  check_keys(table, keys, "[sources]");
  for (const SourceParameter& parameter : source_parameters()) {
    if (const auto* node = table.get(parameter.name)) {
      sources.*parameter.value = number_in(*node, fmt::format("sources.{}", parameter.name),
                                           parameter.low, parameter.high);
    }
  }
  if (const auto* node = table.get("lateral_shift_mode")) {
    const std::string mode = text(*node, "sources.lateral_shift_mode");
    if (mode != "common" && mode != "independent") {
      fail(*node, "lateral_shift_mode is " + in_quotes(mode), "use common or independent");
    }
    sources.lateral_shift_mode = mode == "common" ? ShiftMode::common : ShiftMode::independent;
  }
}

void SettingsReader::read_own_sources(const toml::table& table, SourceSettings& sources) const {
  if (const auto* node = table.get("own")) {
    const std::vector<std::string> known = registered_sources();
    const std::vector<OwnSource> before = std::exchange(sources.own, {});
    for (const toml::node& value : list(*node, "sources.own")) {
      const std::string name = text(value, "an entry of sources.own");
      const auto has_name = [&](const OwnSource& own) { return own.name == name; };
      if (std::find(known.begin(), known.end(), name) == known.end()) {
        fail(value, "unknown source " + in_quotes(name) + " in sources.own",
             known.empty() ? "register it (docs/own-source.md)" : "use " + alternatives(known));
      }
      if (std::any_of(sources.own.begin(), sources.own.end(), has_name)) {
        fail(value, "sources.own lists " + in_quotes(name) + " twice", "remove one");
      }
      const auto old = std::find_if(before.begin(), before.end(), has_name);
      sources.own.push_back(old == before.end() ? OwnSource{name, {}} : *old);
    }
  }
  for (OwnSource& own : sources.own) {
    const std::string start = own.name + ".";
    if (const auto* node = table.get(own.name)) {
      for (const auto& [key, value] : this->table(*node, "[sources." + own.name + "]")) {
        own.options[std::string(key.str())] =
            number(value, "sources." + start + std::string(key.str()));
      }
    }
    for (const auto& [key, value] : table) {
      if (!key.str().starts_with(start)) continue;
      const std::string option(key.str().substr(start.size()));
      own.options[option] = number(value, "sources." + start + option);
    }
  }
  if (const auto* node = table.get("command")) {
    sources.command = command(*node, "sources.command");
  }
  if (const auto* limit = table.get("time_limit_s")) {
    sources.time_limit_s = number_in(*limit, "sources.time_limit_s", 1e-3, 86400);
  }
}

std::string SettingsReader::command(const toml::node& node, const std::string& what) const {
  std::string command = text(node, what);
  std::vector<std::string> words;
  try {
    words = command_words(command, what);
  } catch (const Error& error) {
    fail(node, what + " has an " + error.fault(), error.remedy());
  }
  if (words.empty()) fail(node, what + " is empty", "name the program that answers");
  return command;
}

void SettingsReader::read_camera(const toml::table& table, CameraMount& mount) const {
  check_keys(table, {"height_m", "pitch_deg"}, "[camera]");
  if (const auto* height = table.get("height_m")) {
    mount.height_m = number_in(*height, "camera.height_m", 0.01, 100);
  }
  if (const auto* pitch = table.get("pitch_deg")) {
    mount.pitch_rad = radians_per_degree * number_in(*pitch, "camera.pitch_deg", -89, 89);
  }
}

void SettingsReader::read_map(const toml::table& table, ExperimentSettings& settings) const {
  check_keys(table, {"path", "spacing_m", "headings", "rig"}, "[map]");
  if (const auto* node = table.get("path")) {
    if (text(*node, "map.path") != "default") {
      fail(*node, "map.path is not \"default\"",
           "change the world's [[route]], or remove this key");
    }
  }
  if (const auto* node = table.get("spacing_m")) {
    settings.map_spacing_m = number_in(*node, "map.spacing_m", 0.01, 100);
  }
  if (const auto* node = table.get("headings")) {
    if (node->is_string()) {
      if (text(*node, "map.headings") != "path") {
        fail(*node, "map.headings is neither \"path\" nor a number", "use \"path\" or 1 to 360");
      }
      settings.map_headings = 0;
    } else {
      const auto count = integer(*node, "map.headings");
      if (count < 1 || count > 360) fail(*node, "map.headings is out of range", "use 1 to 360");
      settings.map_headings = static_cast<int>(count);
    }
  }
  if (const auto* node = table.get("rig")) {
    const std::string which = text(*node, "map.rig");
    if (which != "recalibrated" && which != "same") {
      fail(*node, "map.rig is " + in_quotes(which), "use recalibrated or same");
    }
    settings.map_rig = which == "same" ? MapRig::same : MapRig::recalibrated;
  }
}

void SettingsReader::read_corners(const toml::table& table, AppearanceOptions& appearance) const {
  check_keys(table, {"view_change", "noise"}, "[corners]");
  constexpr double most = 100;
  if (const auto* node = table.get("view_change")) {
    appearance.view_change = number_in(*node, "corners.view_change", 0, most);
  }
  if (const auto* node = table.get("noise")) {
    appearance.noise = number_in(*node, "corners.noise", 0, most);
  }
}

ExperimentSettings SettingsReader::read_settings(const toml::table& root,
                                                 const SourceSettings& sources) const {
  ExperimentSettings settings;
  settings.sources = sources;
  const toml::table& study = *root.get("study")->as_table();
  check_keys(study, {"trials", "interval_width", "seed", "protocol"}, "[study]");
  if (const auto* seed = study.get("seed")) {
    const auto value = integer(*seed, "study.seed");
    if (value < 0) fail(*seed, "study.seed is negative", "use 0 or more");
    settings.seed = static_cast<std::uint64_t>(value);
  }
  if (const auto* protocol = study.get("protocol")) {
    settings.protocol =
        word(*protocol, "study.protocol", [](const std::string& w) { return query_protocol(w); });
  }
  if (const auto* own = section(root, "sources")) read_sources(*own, settings.sources);
  if (const auto* corners = section(root, "corners")) read_corners(*corners, settings.appearance);
  if (const auto* map = section(root, "map")) read_map(*map, settings);
  if (const auto* camera = section(root, "camera")) read_camera(*camera, settings.mount);
  if (const auto* localiser = section(root, "localiser")) read_localiser(*localiser, settings);
  if (const auto* histograms = section(root, "histograms")) {
    const bool of_image = uses_image_histograms(settings.method);
    LocaliserOptions& options = settings.localiser;
    read_histograms(*histograms, of_image ? options.image_histograms : options.histograms);
  }
  return settings;
}

void read_sources_file(const std::filesystem::path& file, SourceSettings& sources) {
  const toml::table theirs =
      vernier::internal::parse_toml(vernier::internal::read_whole(file), file.string());
  const SettingsReader reader(file.string());
  reader.check_keys(theirs, {"sources"}, "");
  const toml::table& values =
      reader.table(reader.required(theirs, "sources", "the file"), "[sources]");
  if (const auto* further = values.get("file")) {
    reader.fail(*further, "sources.file in a sources file is not allowed", "copy the values here");
  }
  reader.read_sources(values, sources);
}

}  // namespace vernier::sim::internal
