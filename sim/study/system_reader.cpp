// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/system_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calib/base/shown_text.h"
#include "calib/base/toml_reader.h"
#include "calib/error.h"
#include "sim/experiment.h"
#include "sim/study/study_file.h"
#include "sim/study/system_kind.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

using Type = SystemOption::Type;

bool has(const std::vector<std::string>& all, const std::string& one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

/// Whether an option has an effect beside the others.
bool counts(const SystemOption& option, const SystemSettings& settings) {
  const auto& [other, word] = option.only_with;
  return other.empty() || settings.text(other) == word;
}

/// Columns of a trial that every system has, and what else a measured quantity cannot be called.
const std::vector<std::string> own_columns{
    "cell",  "block",  "trial",   "status", "answered", "success",
    "error", "cpu_ms", "wall_ms", "reason", "question"};  // the number in a program's answer

/// Names of columns of results: small letters, digits and underscores, a letter first.
bool is_name(const std::string& text) {
  constexpr std::size_t longest = 40;
  const auto is_letter = [](char c) { return c >= 'a' && c <= 'z'; };
  return !text.empty() && text.size() <= longest && is_letter(text[0]) &&
         std::all_of(text.begin(), text.end(),
                     [&](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; });
}

/// A text without its quotes, unless it would be taken for a number, a boolean or a quoted text.
std::string shown_parameter(const std::string& json) {
  const nlohmann::json value = nlohmann::json::parse(json);
  if (!value.is_string()) return json;
  const std::string text = value.get<std::string>();
  const bool is_plain = text != "true" && text != "false" && !text.starts_with('"') &&
                        text.find_first_not_of("+-.0123456789eE") != std::string::npos;
  return is_plain ? text : json;
}

}  // namespace

const SystemKind& SystemReader::kind_of(const toml::table& root) const {
  const toml::node* section = root.get("system");
  if (!section) return system_kind("localiser");
  const toml::table& system = table(*section, "[system]");
  if (system.size() == 1 && system.contains("success_error")) return system_kind("localiser");
  const toml::node& node = required(system, "name", "[system]");
  const std::string name = text(node, "system.name");
  const std::vector<std::string> known = system_names();
  if (!has(known, name)) {
    fail(node, "unknown system " + in_quotes(name), "use " + alternatives(known));
  }
  return system_kind(name);
}

std::string SystemReader::value_of(const toml::node& node, const SystemOption& option) const {
  const std::string what = "system." + option.name;
  if (option.type == Type::whole) integer(node, what);  // refuses a fraction
  if (option.type == Type::number || option.type == Type::whole) {
    return fmt::format("{}", number_in(node, what, option.low, option.high));
  }
  if (option.type == Type::command) return command(node, what);
  const std::string said = text(node, what);
  if (option.type == Type::word && !has(option.words, said)) {
    fail(node, what + " is " + in_quotes(said), "use " + alternatives(option.words));
  }
  if (said.empty()) fail(node, what + " is empty", "give it, or leave the key out");
  return said;
}

void SystemReader::read_names(const toml::node& node, SystemSettings& settings) const {
  constexpr std::size_t most = 50;
  for (const toml::node& value : list(node, "system.measured")) {
    const std::string name = text(value, "an entry of system.measured");
    if (!is_name(name) || has(own_columns, name)) {
      fail(value, in_quotes(name) + " is no name of what is measured",
           "use small letters, digits and underscores, and none of " + alternatives(own_columns));
    }
    if (has(settings.measured_names, name)) {
      fail(value, "system.measured lists " + in_quotes(name) + " twice", "remove one");
    }
    settings.measured_names.push_back(name);
    if (settings.measured_names.size() > most) {
      fail(value, fmt::format("system.measured has more than {} names", most), "name fewer");
    }
  }
}

void SystemReader::read_options(const toml::table& section,
                                const SystemKind& kind,
                                SystemSettings& settings) const {
  Keys keys{"name", "success_error"};
  for (const SystemOption& option : kind.options) keys.push_back(option.name);
  check_keys(section, keys, "[system]");
  if (const auto* node = section.get("success_error")) {
    settings.success_error = number(*node, "system.success_error");
    if (!(settings.success_error > 0)) {
      fail(*node, "system.success_error is not above 0",
           "give the largest error of a trial that counts as a success");
    }
    if (!(settings.success_error < kind.largest_error)) {
      fail(*node, "system.success_error is not below " + fmt::format("{:g}", kind.largest_error),
           "the error is a " + kind.error_title);
    }
    if (settings.is_localiser() && settings.success_error > success_radius_m) {
      fail(*node, fmt::format("system.success_error is above {:g} m", success_radius_m),
           "give less: an answer further away is another place");
    }
  } else if (std::isnan(settings.success_error)) {
    required(section, "success_error", "[system]");
  }
  for (const SystemOption& option : kind.options) {
    const toml::node* node = section.get(option.name);
    if (option.type == Type::names) {
      if (node) read_names(*node, settings);
    } else if (node) {
      settings.options[option.name] = value_of(*node, option);
    } else {
      settings.options[option.name] = option.usual;
    }
  }
  for (const SystemOption& option : kind.options) {  // now that it is known which of them count
    if (option.type == Type::names) continue;
    if (!counts(option, settings)) {
      settings.options.erase(option.name);
    } else if (settings.text(option.name).empty()) {
      required(section, option.name.c_str(), "[system]");
    }
  }
}

void SystemReader::read_parameters(const toml::table& section, SystemSettings& settings) const {
  for (const auto& [key, node] : section) {
    const std::string name(key.str()), what = "parameters." + name;
    nlohmann::json value;
    if (node.is_boolean()) {
      value = node.as_boolean()->get();
    } else if (node.is_string()) {
      value = text(node, what);
    } else if (node.is_integer()) {
      value = integer(node, what);
    } else if (node.is_number()) {
      value = number(node, what);
    } else {
      fail(node, shortened(what) + " is neither a number nor a text nor a boolean",
           "give one value; to try several, sweep \"" + shortened(what) + "\"");
    }
    settings.parameters[name] = value.dump();
  }
}

/// Throws Error for a key that has no effect on the system.
void SystemReader::refuse(const toml::table& root,
                          const char* section,
                          const char* key,
                          const SystemKind& kind) const {
  const toml::table* table = root.get_as<toml::table>(section);
  const toml::node* node = table ? table->get(key) : nullptr;
  if (!node) return;
  fail(*node, fmt::format("{}.{} has no effect on {}", section, key, kind.noun), "remove it");
}

void SystemReader::check_use(const toml::table& root, const SystemKind& kind) const {
  const std::vector<std::string> always{"study", "system", "rig", "sweep", "tune"};
  for (const auto& [key, node] : root) {
    const std::string name(key.str());
    if (has(always, name) || kind.uses(name)) continue;
    const bool is_of_sweep = key.source().begin.line == 0 && node.is_table();
    const std::string what =
        is_of_sweep ? name + "." + shortened(std::string(node.as_table()->begin()->first.str()))
                    : "[" + name + "]";
    fail(node, what + " has no effect on " + kind.noun, "remove it");
  }
  if (!kind.uses_protocol) refuse(root, "study", "protocol", kind);
  if (!kind.tells_rigs) {
    refuse(root, "rig", "truth", kind);
    refuse(root, "rig", "error", kind);
  }
  const toml::table* sources = root.get_as<toml::table>("sources");
  if (!sources || kind.sources != SourcesUsed::calibration) return;
  for (const auto& [key, node] : *sources) {
    if (key.str() == "calibration") continue;
    fail(
        node,
        fmt::format("sources.{} has no effect on {}", shortened(std::string(key.str())), kind.noun),
        "remove it; sources.calibration alone acts");
  }
}

SystemSettings SystemReader::read(const toml::table& root) const {
  const SystemKind& kind = kind_of(root);
  check_use(root, kind);
  SystemSettings settings;
  settings.name = kind.name;
  settings.success_error = kind.success_error;
  for (const MeasuredQuantity& of : kind.measured) settings.measured_names.push_back(of.name);
  const toml::table empty;
  const toml::table* section = root.get_as<toml::table>("system");
  read_options(section ? *section : empty, kind, settings);
  if (const toml::node* node = root.get("parameters")) {
    read_parameters(table(*node, "[parameters]"), settings);
  }
  return settings;
}

void SystemReader::check_sweep_key(const toml::table& root,
                                   const std::string& key,
                                   const toml::node& at) const {
  const SystemKind& kind = kind_of(root);
  const auto fixed = [&](const SystemOption& option) {
    return option.type == Type::names && key == "system." + option.name;
  };
  if (key != "system.name" && std::none_of(kind.options.begin(), kind.options.end(), fixed)) return;
  fail(at, in_quotes(key) + " cannot be swept: the cells would have other columns",
       "make a study for each");
}

void check_options_are_used(const StudyFile& study) {
  for (const SystemOption& option : system_of(study).options) {
    const std::string key = "system." + option.name;
    const auto uses = [&](const StudyCell& cell) {
      return cell.system.options.contains(option.name);
    };
    if (option.type == Type::names || study.lines.count(key) == 0 ||
        std::any_of(study.cells.begin(), study.cells.end(), uses)) {
      continue;
    }
    const auto& [other, word] = option.only_with;
    throw Error(
        place_of(study, key),
        fmt::format("{} is set, but no system.{} is \"{}\", so it is not used", key, other, word),
        fmt::format("set {} = \"{}\", or leave it out", other, word));
  }
}

std::map<std::string, std::string> settings_of(const SystemSettings& system) {
  std::map<std::string, std::string> all;
  all["system.success_error"] = fmt::format("{}", system.success_error);
  if (system.is_localiser()) return all;
  all["system.name"] = system.name;
  for (const auto& [name, value] : system.options) all["system." + name] = value;
  for (const auto& [name, value] : system.parameters) {
    all["parameters." + name] = shown_parameter(value);
  }
  if (system_kind(system.name).measured.size() == system.measured_names.size()) return all;
  for (const std::string& name : system.measured_names) {
    std::string& names = all["system.measured"];
    names += (names.empty() ? "" : ", ") + name;
  }
  return all;
}

bool applies_on_reading(const std::string& key) { return key == "system.success_error"; }

bool uses_setting(const SystemKind& kind, const std::string& key) {
  const std::string section = key.substr(0, key.find('.'));
  if (section == "rig") return true;
  if (section == "study") return key != "study.protocol" || kind.uses_protocol;
  if (section == "sources" && kind.sources == SourcesUsed::calibration) {
    return key == "sources.calibration";
  }
  return kind.uses(section);
}

}  // namespace vernier::sim::internal
