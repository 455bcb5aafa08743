// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/one_at_a_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

#include "calib/base/nearest_word.h"
#include "calib/base/shown_text.h"
#include "calib/base/toml_reader.h"
#include "calib/error.h"
#include "sim/experiment.h"
#include "sim/sources.h"
#include "sim/study/idle_settings.h"
#include "sim/study/study_file.h"
#include "sim/study/study_keys.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

constexpr const char *design_key = "design", *source_key = "source", *value_key = "value";
constexpr const char *as_set = "as set", *no_source = "no source", *only_design = "only",
                     *all_but_design = "all but", *swept_design = "swept";

/// Sources that can be switched off.
std::vector<const SourceParameter*> switches() {
  std::vector<const SourceParameter*> all;
  for (const SourceParameter& p : source_parameters()) {
    if (p.is_switch) all.push_back(&p);
  }
  return all;
}

const SourceParameter* switch_named(std::string_view name) {
  const SourceParameter* found = source_parameter(name);
  return found && found->is_switch ? found : nullptr;
}

void read_designs(const TomlReader& reader, const toml::node& node, OneAtATime& read) {
  for (const toml::node& entry : reader.list(node, "one_at_a_time.designs")) {
    const std::string word = reader.text(entry, "a design");
    if (word == "only") {
      read.only = true;
    } else if (word == "all_but") {
      read.all_but = true;
    } else if (word == "swept") {
      read.swept = true;
    } else {
      reader.fail(entry, "one_at_a_time.designs: " + in_quotes(word) + " is unknown",
                  "use \"only\", \"all_but\" or \"swept\"");
    }
  }
}

void read_sources(const TomlReader& reader, const toml::node& node, OneAtATime& read) {
  for (const toml::node& entry : reader.list(node, "one_at_a_time.sources")) {
    const std::string word = reader.text(entry, "a source");
    if (!switch_named(word)) {
      std::vector<std::string_view> known;
      for (const SourceParameter* p : switches()) known.push_back(p->name);
      reader.fail(entry,
                  "one_at_a_time.sources: " + in_quotes(word) + " is no source that can be off",
                  unknown_word_remedy(word, known));
    }
    if (std::find(read.sources.begin(), read.sources.end(), word) != read.sources.end()) {
      reader.fail(entry, "one_at_a_time.sources lists " + word + " twice", "remove one");
    }
    read.sources.push_back(word);
  }
  if (read.sources.empty()) {
    reader.fail(node, "one_at_a_time.sources is empty", "list at least one, or remove it for all");
  }
}

void read_factors(const TomlReader& reader, const toml::node& node, OneAtATime& read) {
  read.factors.clear();
  for (const toml::node& entry : reader.list(node, "one_at_a_time.factors")) {
    const double factor = reader.number(entry, "a factor");
    if (!(factor > 0 && factor <= 1000) || factor == 1) {
      reader.fail(entry, fmt::format("one_at_a_time.factors: {} is no factor of a sweep", factor),
                  "use 0 < factor <= 1000 other than 1; the design all_but has 0");
    }
    if (std::find(read.factors.begin(), read.factors.end(), factor) != read.factors.end()) {
      reader.fail(entry, fmt::format("one_at_a_time.factors lists {} twice", factor), "remove one");
    }
    read.factors.push_back(factor);
  }
}

/// The cell with other sources.
StudyCell with_sources(const StudyCell& cell, const SourceSettings& sources) {
  StudyCell changed = cell;
  changed.experiment.sources = sources;
  std::erase_if(changed.settings, [](const auto& s) { return s.first.starts_with("sources."); });
  for (const auto& [key, value] : settings_of(changed.experiment)) {
    if (key.starts_with("sources.")) changed.settings[key] = value;
  }
  return changed;
}

void name_design(StudyCell& cell,
                 const std::string& design,
                 const std::string& source,
                 const std::string& value) {
  const bool first = cell.swept.empty();
  cell.swept.emplace_back(design_key, design);
  cell.swept.emplace_back(source_key, source);
  cell.swept.emplace_back(value_key, value);
  std::string words = design;
  if (!source.empty()) words += " " + source + " = " + value;
  cell.label = first ? words : cell.label + ", " + words;
}

/// The sources of the designs: those named, or all that are on and may act.
std::vector<const SourceParameter*> chosen_sources(const StudyCell& cell,
                                                   const OneAtATime& designs) {
  std::vector<const SourceParameter*> chosen;
  const SourceSettings& sources = cell.experiment.sources;
  if (designs.sources.empty()) {
    for (const SourceParameter* p : switches()) {
      if (sources.*p->value != 0 && why_idle(key_of(*p), cell).empty()) chosen.push_back(p);
    }
  }
  for (const std::string& name : designs.sources) {
    chosen.push_back(switch_named(name));
    if (designs.only && !designs.all_but && !designs.swept &&
        chosen.back()->value == &SourceSettings::epipolar_reject_deg) {
      throw Error(designs.sources_place,
                  "one_at_a_time.sources: " + name +
                      " adds no error alone: design \"only\" keeps it as it is set in all cells",
                  "leave it out, or use design \"all_but\" or \"swept\"");
    }
    if (sources.*chosen.back()->value == 0) {
      throw Error(designs.sources_place,
                  "one_at_a_time.sources: sources." + name + " is 0, so it is off everywhere",
                  "set it in [sources], or leave it out");
    }
  }
  if (chosen.empty()) {
    throw Error(designs.sources_place, "one_at_a_time: no source is on that can act",
                "set one in [sources]");
  }
  return chosen;
}

}  // namespace

OneAtATime read_one_at_a_time(const toml::table& table, const std::string& place) {
  const TomlReader reader(place);
  reader.check_keys(table, {"designs", "sources", "factors"}, "[one_at_a_time]");
  OneAtATime read;
  const toml::node& designs = reader.required(table, "designs", "[one_at_a_time]");
  read_designs(reader, designs, read);
  if (const auto* sources = table.get("sources")) read_sources(reader, *sources, read);
  if (const auto* factors = table.get("factors")) read_factors(reader, *factors, read);
  if (!read.only && !read.all_but && !read.swept) {
    reader.fail(designs, "one_at_a_time.designs is empty", "list \"only\", \"all_but\", \"swept\"");
  }
  if (read.swept && read.factors.empty()) {
    reader.fail(*table.get("factors"), "one_at_a_time.factors is empty", "list at least one");
  }
  const auto place_of = [&](const char* key) {
    const toml::node* node = table.get(key);
    return fmt::format("{}:{}", place, (node ? node->source() : table.source()).begin.line);
  };
  read.sources_place = place_of("sources");
  read.factors_place = place_of("factors");
  return read;
}

std::vector<StudyCell> one_at_a_time(const StudyCell& cell, const OneAtATime& designs) {
  const std::vector<const SourceParameter*> sources = chosen_sources(cell, designs);
  const SourceSettings &all = cell.experiment.sources, none = [&] {
    SourceSettings off = no_sources();
    for (const SourceParameter& p : source_parameters()) {
      if (!p.is_switch) off.*p.value = cell.experiment.sources.*p.value;  // magnitudes stay
    }
    off.lateral_shift_mode = cell.experiment.sources.lateral_shift_mode;
    off.epipolar_reject_deg = all.epipolar_reject_deg;  // what stereo cannot tell is no error
    return off;
  }();
  std::vector<StudyCell> cells;
  const auto add = [&](const SourceSettings& with, const char* design, const SourceParameter* p,
                       double value) {
    cells.push_back(with_sources(cell, with));
    name_design(cells.back(), design, p ? std::string(p->name) : "",
                p ? fmt::format("{}", value) : "");
  };
  add(all, as_set, nullptr, 0);
  if (designs.only) {
    add(none, no_source, nullptr, 0);
    for (const SourceParameter* p : sources) {
      if (p->value == &SourceSettings::epipolar_reject_deg) continue;
      SourceSettings with = none;
      with.*p->value = all.*p->value;
      add(with, only_design, p, all.*p->value);
    }
  }
  for (const SourceParameter* p : sources) {
    if (!designs.all_but) break;
    SourceSettings with = all;
    with.*p->value = 0;
    add(with, all_but_design, p, 0);
  }
  for (const SourceParameter* p : sources) {
    if (!designs.swept) break;
    for (const double factor : designs.factors) {
      SourceSettings with = all;
      with.*p->value = factor * all.*p->value;
      if (with.*p->value > p->high || with.*p->value < p->low) {
        throw Error(designs.factors_place,
                    fmt::format("one_at_a_time.factors: {} times sources.{} = {} is out of its "
                                "range, {} to {}",
                                factor, p->name, all.*p->value, p->low, p->high),
                    "use a smaller factor, or name the sources to sweep");
      }
      add(with, swept_design, p, with.*p->value);
    }
  }
  return cells;
}

std::string varied_source(const StudyCell& cell) { return swept_value(cell, source_key); }

bool has_design(const StudyCell& cell) { return !swept_value(cell, design_key).empty(); }

bool is_reference_of(const StudyCell& reference, const StudyCell& cell) {
  const std::string design = swept_value(cell, design_key);
  if (design == as_set || design == no_source || design.empty()) return false;
  if (swept_value(reference, design_key) != (design == only_design ? no_source : as_set)) {
    return false;
  }
  return std::all_of(cell.swept.begin(), cell.swept.end(), [&](const auto& entry) {
    const auto& [key, value] = entry;
    return key == design_key || key == source_key || key == value_key ||
           swept_value(reference, key) == value;
  });
}

}  // namespace vernier::sim::internal
