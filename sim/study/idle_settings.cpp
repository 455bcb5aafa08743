// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/idle_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>

#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "localise/localiser.h"
#include "localise/pgh.h"
#include "sim/experiment.h"
#include "sim/moved_furniture.h"
#include "sim/sources.h"
#include "sim/study/one_at_a_time.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_keys.h"
#include "sim/study/system_kind.h"
#include "sim/study/system_reader.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using namespace localise;
using namespace vernier::internal;

namespace {

std::string method_is(const StudyCell& cell) {
  return "localiser.method is " + in_quotes(cell.experiment.method);
}

std::string why_localiser_idle(std::string_view name, const StudyCell& cell) {
  if (name == "method") return {};
  const std::string_view option = name == "knows_endpoint_sigma" ? "endpoint_sigma" : name;
  const std::string& method = cell.experiment.method;
  const LocaliserOptions& options = cell.experiment.localiser;
  if (!uses_option(method, option)) return method_is(cell);
  if (!uses_option(method, option, options)) {
    return "localiser.stages is " + in_quotes(localise::name(options.stages));
  }
  const int most = most_candidates(method);
  if (option != "candidates" || options.candidates < most) return {};
  return fmt::format("{} looks at {} at most", method, most);
}

std::string why_histograms_idle(std::string_view name, const StudyCell& cell) {
  const ExperimentSettings& settings = cell.experiment;
  if (!uses_option(settings.method, "histograms", settings.localiser)) {
    return uses_option(settings.method, "ranker")
               ? "localiser.ranker is " + in_quotes(settings.localiser.ranker)
               : method_is(cell);
  }
  const bool of_image = uses_image_histograms(settings.method);
  if (of_image && name == "height_bands") return method_is(cell);
  const PghOptions& histograms =
      of_image ? settings.localiser.image_histograms : settings.localiser.histograms;
  const bool is_width = name == "angle_sigma_deg" || name == "distance_sigma";
  if (!is_width || histograms.blur == PghBlur::fixed) return {};
  return "histograms.blur is " + in_quotes(std::string(localise::name(histograms.blur)));
}

/// Whether the method looks at corners, and not only their cost is paid.
bool looks_at_corners(const ExperimentSettings& settings) {
  return needs_corners(settings.method, settings.localiser) &&
         uses_option(settings.method, "corners");
}

bool sees(SourceTarget target, const StudyCell& cell) {
  if (target == SourceTarget::view) return true;
  if (!cell.system.is_localiser()) return target == SourceTarget::edges;
  return target == SourceTarget::edges ? uses_lines(cell.experiment.method)
                                       : looks_at_corners(cell.experiment);
}

std::string why_unseen(SourceTarget target, const StudyCell& cell) {
  if (sees(target, cell)) return {};
  return cell.system.is_localiser() ? method_is(cell)
                                    : system_kind(cell.system.name).noun + " sees no corners";
}

std::string why_source_idle(const std::string& name, const StudyCell& cell) {
  const SourceSettings& sources = cell.experiment.sources;
  if (name == "time_limit_s") return sources.command.empty() ? "sources.command is not set" : "";
  if (name == "lateral_shift_mode") {
    const std::string why = why_unseen(SourceTarget::edges, cell);
    return why.empty() && sources.lateral_shift_px == 0 ? "sources.lateral_shift_px is 0" : why;
  }
  const SourceParameter* source = source_parameter(name);
  if (!source) return {};
  const bool is_calibration = source->value == &SourceSettings::calibration;
  if (is_calibration && cell.system.is_localiser() &&
      uses_image_histograms(cell.experiment.method)) {
    return method_is(cell);  // it has one image's lines alone
  }
  if (std::string why = why_unseen(source->acts_on, cell); !why.empty()) return why;
  const SourceParameter* off = switched_off_with(*source, sources);
  return off ? key_of(*off) + " is 0" : "";
}

/// The same where the cell's world is known.
std::string why_idle_there(const std::string& key, const StudyCell& cell, const Study& study) {
  const std::string why = why_idle(key, cell);
  if (!why.empty() || !key.starts_with("sources.")) return why;
  const SourceParameter* source = source_parameter(std::string_view(key).substr(8));
  if (!source || !system_kind(cell.system.name).uses("world")) return {};
  const World& world = world_of(study, cell);
  if (source->value == &SourceSettings::moved && !has_furniture(world)) {
    return "the world " + cell.world + " has no furniture";
  }
  if (source->acts_on == SourceTarget::corners && world.corners.empty()) {
    return "the world " + cell.world + " has no corners";
  }
  return {};
}

/// Empty if the setting acts in a cell; else why it does not in the first.
std::string why_idle_in_all(const std::string& key, const Study& study) {
  std::string first;
  for (const StudyCell& cell : study.file.cells) {
    const std::string why = why_idle_there(key, cell, study);
    if (why.empty()) return {};
    if (first.empty()) first = why;
  }
  return first;
}

/// Settings that cells list only where they are used.
std::map<std::string, std::string> unlisted_settings(const ExperimentSettings& settings) {
  return {{"corners.view_change", fmt::format("{}", settings.appearance.view_change)},
          {"corners.noise", fmt::format("{}", settings.appearance.noise)},
          {"localiser.min_corners", fmt::format("{}", settings.localiser.min_corners)},
          {"sources.time_limit_s", fmt::format("{}", settings.sources.time_limit_s)}};
}

/// Whether a setting has its default in all cells.
bool is_usual(const std::string& key, const StudyFile& study) {
  if (key == "localiser.command" || key == "localiser.time_limit_s") return false;
  const auto value = [&](const auto& listed, const ExperimentSettings& settings) {
    const auto found = listed.find(key);
    if (found != listed.end()) return found->second;
    const auto unlisted = unlisted_settings(settings);
    const auto other = unlisted.find(key);
    return other == unlisted.end() ? std::string() : other->second;
  };
  const ExperimentSettings defaults;
  const std::string usual = value(settings_of(defaults), defaults);
  return std::all_of(study.cells.begin(), study.cells.end(), [&](const StudyCell& cell) {
    const std::string set = value(cell.settings, cell.experiment);
    return set.empty() || set == usual;
  });
}

/// Whether it describes images, not what looks at them or how.
bool is_source_of_error(const std::string& key) {
  return key.starts_with("sources.") && key != "sources.time_limit_s";
}

bool is_off_in_all(const std::string& key, const StudyFile& study) {
  return std::all_of(study.cells.begin(), study.cells.end(), [&](const StudyCell& cell) {
    const auto set = cell.settings.find(key);
    return set != cell.settings.end() && set->second == "0";
  });
}

[[noreturn]] void refuse(const std::string& key,
                         const std::string& reason,
                         const StudyFile& study) {
  const std::string with = reason.substr(0, reason.find(' '));
  const bool is_of_setting = with.find('.') != std::string::npos;
  throw Error(place_of(study, key), key + " has no effect: " + reason,
              "leave it out" + (is_of_setting ? ", or change " + with : ""));
}

void check_designs(const Study& study) {
  if (study.file.lines.count("one_at_a_time.sources") == 0) return;  // it was not asked for
  for (const StudyCell& cell : study.file.cells) {
    const std::string source = varied_source(cell);
    if (source.empty()) continue;
    const std::string key = key_of(*source_parameter(source));
    const std::string reason = why_idle_in_all(key, study);
    if (reason.empty()) continue;
    throw Error(place_of(study.file, "one_at_a_time.sources"),
                "one_at_a_time varies " + key + ", which has no effect: " + reason,
                "name in one_at_a_time.sources those that act");
  }
}

/// Throws Error for a cell whose every answer would be unsure.
void check_answers_are_possible(const StudyFile& study) {
  for (const StudyCell& cell : study.cells) {
    if (!cell.system.is_localiser() ||
        can_be_sure(cell.experiment.method, cell.experiment.localiser)) {
      continue;
    }
    throw Error(place_of(study, "localiser.stages"),
                "localiser.stages = " + in_quotes(name(cell.experiment.localiser.stages)) +
                    " states no probability, so that every answer would be unsure",
                "set localiser.max_error_rate = 1, or add the stage compare");
  }
}

/// Throws Error for a cell that would be unsure where it wants no further look.
void check_look_rates(const StudyFile& study) {
  for (const StudyCell& cell : study.cells) {
    const LocaliserOptions& options = cell.experiment.localiser;
    if (options.look_error_rate.value_or(0) <= options.max_error_rate) continue;
    throw Error(place_of(study, "localiser.look_error_rate"),
                fmt::format("localiser.look_error_rate = {:g} is above localiser.max_error_rate = "
                            "{:g}",
                            *options.look_error_rate, options.max_error_rate),
                "use a smaller one, or leave it out: where the localiser does not answer, it asks "
                "for a further look in any case");
  }
}

}  // namespace

std::string key_of(const SourceParameter& source) { return "sources." + std::string(source.name); }

std::string why_idle(const std::string& key, const StudyCell& cell) {
  const std::size_t dot = key.find('.');
  const std::string section = key.substr(0, dot), name = key.substr(dot + 1);
  const ExperimentSettings& settings = cell.experiment;
  if (section == "sources") return why_source_idle(name, cell);
  if (!cell.system.is_localiser()) return {};
  if (section == "localiser") return why_localiser_idle(name, cell);
  if (section == "histograms") return why_histograms_idle(name, cell);
  if (section == "corners") return looks_at_corners(settings) ? "" : method_is(cell);
  if (key == "map.rig") {
    return settings.sources.calibration == 0 ? "sources.calibration is 0"
                                             : why_source_idle("calibration", cell);
  }
  return {};
}

std::vector<IdleSource> check_settings_act(const Study& study) {
  const StudyFile& file = study.file;
  check_options_are_used(file);
  check_designs(study);
  check_answers_are_possible(file);
  check_look_rates(file);
  std::vector<IdleSource> idle;
  for (const auto& [key, line] : file.lines) {
    if (key.find('.') == std::string::npos) continue;
    const std::string reason = why_idle_in_all(key, study);
    if (reason.empty()) continue;
    const auto& swept = file.sweep_keys;
    const bool is_swept = std::find(swept.begin(), swept.end(), key) != swept.end();
    if (!is_swept && is_usual(key, file)) continue;
    if (is_swept || !is_source_of_error(key)) refuse(key, reason, file);
    if (!is_off_in_all(key, file)) idle.push_back({key, reason});
  }
  return idle;
}

}  // namespace vernier::sim::internal
