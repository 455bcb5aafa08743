// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/study_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>

#include "calib/base/atomic_file.h"
#include "calib/base/nearest_word.h"
#include "calib/base/shown_text.h"
#include "calib/base/toml_reader.h"
#include "calib/error.h"
#include "sim/experiment.h"
#include "sim/sources.h"
#include "sim/study/one_at_a_time.h"
#include "sim/study/settings_reader.h"
#include "sim/study/study_keys.h"
#include "sim/study/success_interval.h"
#include "sim/study/system_kind.h"
#include "sim/study/system_reader.h"
#include "sim/study/told_settings.h"
#include "sim/visibility.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

constexpr std::size_t most_cells = 10'000;
constexpr std::int64_t most_trials = 10'000'000;  ///< of all cells together

class StudyReader : private SettingsReader {
 public:
  using SettingsReader::SettingsReader;

  StudyFile read(const toml::table& root, const std::filesystem::path& sources);

 private:
  void read_study_section(const toml::table& root, StudyFile& study) const;
  void read_world(const toml::table& root, StudyCell& cell) const;
  StudyCell read_cell(const toml::table& root, toml::source_index line = 0) const;
  void check_sweep_key(const toml::table& root, const std::string& key, const toml::node& at) const;
  std::filesystem::path read_sources_file(const toml::table& root,
                                          const std::filesystem::path& instead);
  void read_sweep(const toml::table& root, StudyFile& study) const;
  void check_sweep_size(const toml::table& root, const StudyFile& study) const;
  void add_cells(const toml::table& root, StudyFile& study) const;
  void add_designs(const toml::table& root, StudyFile& study) const;
  void note_lines(const toml::table& root, StudyFile& study) const;

  SourceSettings sources_;  // initial values of the study's [sources]
};

void StudyReader::read_study_section(const toml::table& root, StudyFile& study) const {
  const toml::node& node = required(root, "study", "the file");
  const toml::table& section = table(node, "[study]");
  if (const auto* trials = section.get("trials")) {
    const std::int64_t wanted = integer(*trials, "study.trials");
    study.trials = static_cast<int>(wanted);
    if (wanted < 1 || wanted > most_trials) {
      fail(*trials, fmt::format("study.trials = {} is out of range", wanted),
           fmt::format("use 1 to {}", most_trials));
    }
  }
  study.trials_per_block = block_size(study.trials);
  if (const auto* width = section.get("interval_width")) {
    study.interval_width = number_in(*width, "study.interval_width", 0.001, 1);
  }
}

void StudyReader::read_world(const toml::table& root, StudyCell& cell) const {
  const auto* world = section(root, "world");
  if (!world) return;
  check_keys(*world, {"file", "visibility"}, "[world]");
  if (const auto* file = world->get("file")) cell.world = file_name(*file, "world.file");
  if (const auto* visibility = world->get("visibility")) {
    const std::string method = text(*visibility, "world.visibility");
    if (method != "exact" && method != "view_sets") {
      fail(*visibility, "world.visibility = " + in_quotes(method) + " is unknown",
           "use \"exact\" or \"view_sets\"");
    }
    if (method == "view_sets") cell.visibility = VisibilityMethod::view_sets;
  }
}

/// What the settings of a file, or of one combination of a sweep, say. `line` as for TomlReader.
StudyCell StudyReader::read_cell(const toml::table& root, toml::source_index line) const {
  const StudyReader reader(place(), line);
  StudyCell cell;
  cell.experiment = reader.read_settings(root, sources_);
  reader.read_world(root, cell);
  cell.told = ToldReader(place(), line).read(root);
  cell.system = SystemReader(place(), line).read(root);
  const SystemKind& kind = system_kind(cell.system.name);
  if (kind.sources == SourcesUsed::none) cell.experiment.sources.calibration = 0;
  if (kind.calibrates && !cell.told.calibration) cell.told.calibration.emplace();
  return cell;
}

/// The file that [sources] refers to, and its values.
std::filesystem::path StudyReader::read_sources_file(const toml::table& root,
                                                     const std::filesystem::path& instead) {
  const toml::table* own = section(root, "sources");
  const toml::node* node = own ? own->get("file") : nullptr;
  if (!node) return {};
  std::filesystem::path file = instead.empty() ? std::filesystem::path(place()).parent_path() /
                                                     file_name(*node, "sources.file")
                                               : instead;
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(file, unknown)) {
    fail(*node, "sources.file: no such file: " + file.string(),
         "give the path relative to the study file");
  }
  vernier::sim::internal::read_sources_file(file, sources_);
  return file;
}

void StudyReader::check_sweep_key(const toml::table& root,
                                  const std::string& key,
                                  const toml::node& node) const {
  const std::string head = key.substr(0, key.find('.'));
  const Keys sections{"study",  "world", "rig",       "calibration", "sources", "corners",
                      "camera", "map",   "localiser", "histograms",  "system",  "parameters"};
  SystemReader(place()).check_sweep_key(root, key, node);
  if (head == "calibration") ToldReader(place()).check_told_once(root);
  if (key == "rig.file" && !(section(root, "rig") && section(root, "rig")->contains("truth"))) {
    fail(node, "a rig is its own truth unless rig.truth is given: the cells would show other rigs",
         "name the true rig as rig.truth; rig.file is then what the estimator is told of it");
  }
  const auto* calibration = section(root, "calibration");
  if ((key == "calibration.board" || key == "calibration.square_m") && calibration &&
      calibration->contains("observations")) {
    fail(node, key + " is that of calibration.observations", "sweep calibration.views instead");
  }
  if (key.find('.') != std::string::npos &&
      (std::find(sections.begin(), sections.end(), head) == sections.end() ||
       key == "study.trials" || key == "study.interval_width" || key == "sources.file" ||
       key == "rig.truth" || key == "calibration.observations")) {
    const auto meant = misspelt_word(head, {sections.begin(), sections.end()});
    fail(node, "'" + shortened(key) + "' cannot be swept",
         meant ? "did you mean '" + *meant + shortened(key.substr(head.size())) + "'?"
               : "sweep a key of [sources], [corners], [camera], [map], [localiser], [histograms], "
                 "[calibration], [system] or [parameters], study.protocol, study.seed, world.file, "
                 "rig.file or rig.error");
  }
  if (key.find('.') == std::string::npos || node.is_table()) {
    fail(node, fmt::format("sweep key '{}' is not a quoted \"section.key\"", shortened(key)),
         "write \"sources.calibration\" = [0.1, 1, 10]");
  }
}

void StudyReader::read_sweep(const toml::table& root, StudyFile& study) const {
  const auto* sweep = section(root, "sweep");
  if (!sweep) return;
  if (sweep->empty()) {
    fail(*sweep, "[sweep] sweeps nothing",
         "list values of a key, as \"sources.calibration\" = [0.1, 1, 10], or leave it out");
  }
  // toml++ sorts tables by key; the order in the file decides which sweep is slowest.
  std::vector<std::pair<toml::source_position, std::string>> keys;
  for (const auto& [key, value] : *sweep) {
    keys.emplace_back(key.source().begin, std::string(key.str()));
  }
  std::sort(keys.begin(), keys.end(), [](const auto& a, const auto& b) {
    return std::pair(a.first.line, a.first.column) < std::pair(b.first.line, b.first.column);
  });
  for (const auto& [position, key] : keys) {
    const toml::node& node = *sweep->get(key);
    check_sweep_key(root, key, node);
    std::vector<std::string> values;
    const toml::array& listed = list(node, "sweep." + key);
    if (listed.size() > most_cells) {
      fail(node, fmt::format("the sweep of {} has {} values", key, listed.size()),
           fmt::format("list at most {}", most_cells));
    }
    for (const toml::node& value : listed) {
      values.push_back(shown_value(value));
      if (std::find(values.begin(), values.end() - 1, values.back()) != values.end() - 1) {
        fail(value, fmt::format("the sweep of {} lists {} twice", shortened(key), values.back()),
             "remove one");
      }
      toml::table changed = root;  // each value separately first, so that an error has its line
      set_swept(changed, key, value);
      read_cell(changed, value.source().begin.line);
    }
    if (values.empty())
      fail(node, "the sweep of " + shortened(key) + " is empty", "list at least one value");
    study.sweep_keys.push_back(key);
    study.sweep_values.push_back(std::move(values));
  }
}

/// Of the product of all lists, before anything is made of it.
void StudyReader::check_sweep_size(const toml::table& root, const StudyFile& study) const {
  const toml::node* sweep = root.get("sweep");
  if (!sweep) return;
  std::size_t cells = 1;
  for (const auto& values : study.sweep_values) {
    cells *= values.size();
    if (cells <= most_cells) continue;
    fail(*sweep,
         fmt::format("the sweep has more than {} cells, combinations of its values", most_cells),
         "sweep fewer values, or in several studies");
  }
  const std::int64_t trials = static_cast<std::int64_t>(cells) * study.trials;
  if (trials <= most_trials) return;
  fail(*sweep,
       fmt::format("{} cells of {} trials are {} trials, more than {}", cells, study.trials, trials,
                   most_trials),
       "sweep fewer values, or reduce study.trials");
}

void StudyReader::add_cells(const toml::table& root, StudyFile& study) const {
  const toml::table* sweep = section(root, "sweep");
  std::size_t count = 1;
  for (const auto& values : study.sweep_values) count *= values.size();
  for (std::size_t cell = 0; cell < count; ++cell) {
    toml::table changed = root;
    changed.erase("sweep");
    std::vector<std::pair<std::string, std::string>> swept;
    std::string label;
    std::size_t rest = cell, block = count;
    for (std::size_t k = 0; k < study.sweep_keys.size(); ++k) {
      block /= study.sweep_values[k].size();
      const std::size_t i = rest / block;
      rest %= block;
      const std::string& key = study.sweep_keys[k];
      set_swept(changed, key, *sweep->get(key)->as_array()->get(i));
      label += (label.empty() ? "" : ", ") + key + " = " + study.sweep_values[k][i];
      swept.emplace_back(key, study.sweep_values[k][i]);
    }
    StudyCell result = read_cell(changed);
    result.swept = std::move(swept);
    result.settings = settings_of(result.experiment);
    result.settings.merge(shown_settings_of(result.told));
    std::erase_if(result.settings, [&](const auto& setting) {
      return !uses_setting(system_kind(result.system.name), setting.first);
    });
    result.settings.merge(settings_of(result.system));
    for (const std::string& key : study.sweep_keys) {
      if (key == "world.file") result.settings[key] = result.world;
    }
    result.label = label.empty() ? "as set" : label;
    study.cells.push_back(std::move(result));
  }
}

/// Replaces each cell by those of [one_at_a_time].
void StudyReader::add_designs(const toml::table& root, StudyFile& study) const {
  const auto* node = section(root, "one_at_a_time");
  if (!node) return;
  const OneAtATime designs = read_one_at_a_time(*node, place());
  std::vector<StudyCell> cells;
  for (const StudyCell& cell : study.cells) {
    for (StudyCell& one : one_at_a_time(cell, designs)) cells.push_back(std::move(one));
    const auto trials = static_cast<std::int64_t>(cells.size()) * study.trials;
    if (cells.size() <= most_cells && trials <= most_trials) continue;
    fail(*node,
         fmt::format("the study has more than {} cells or {} trials", most_cells, most_trials),
         "name fewer one_at_a_time.sources or factors, or reduce study.trials");
  }
  study.cells = std::move(cells);
}

void StudyReader::note_lines(const toml::table& root, StudyFile& study) const {
  const auto line = [](const auto& of) { return static_cast<int>(of.source().begin.line); };
  study.place = place();
  for (const auto& [name, node] : root) {
    study.lines[std::string(name.str())] = line(name);
    if (name.str() == "sweep" || !node.is_table()) continue;
    for (const auto& [key, value] : *node.as_table()) {
      study.lines[fmt::format("{}.{}", name.str(), key.str())] = line(key);
    }
  }
  if (const auto* sweep = section(root, "sweep")) {
    for (const auto& [key, value] : *sweep) study.lines[std::string(key.str())] = line(key);
  }
}

StudyFile StudyReader::read(const toml::table& root, const std::filesystem::path& sources) {
  check_keys(root,
             {"study", "world", "rig", "calibration", "sources", "corners", "camera", "map",
              "localiser", "histograms", "system", "parameters", "sweep", "one_at_a_time",
              "tune"},  // [tune]: sim/tuning
             "");
  StudyFile study;
  note_lines(root, study);
  read_study_section(root, study);
  study.sources = read_sources_file(root, sources);
  // The file's own values first, with their own lines.
  const bool localises = read_cell(root).system.is_localiser();
  if (!localises) study.trials_per_block = independent_block_size(study.trials);
  read_sweep(root, study);
  ToldReader(place()).check_complete(root, study.sweep_keys);
  check_sweep_size(root, study);
  add_cells(root, study);
  add_designs(root, study);
  const StudyCell& first = study.cells[0];
  study.world = first.world;
  if (!first.told.truth.empty()) {
    study.rig = first.told.truth;
  } else if (!first.told.file.empty()) {
    study.rig = first.told.file;
  }
  for (const StudyCell& cell : study.cells) {
    if (cell.visibility == VisibilityMethod::exact || cell.experiment.sources.moved == 0) continue;
    throw Error(place_of(study, "world.visibility"),
                "sources.moved moves what the view sets of the world name",
                "set world.visibility = \"exact\", or moved = 0");
  }
  return study;
}

std::vector<std::string> named_by_cells(const StudyFile& study,
                                        const std::function<std::string(const StudyCell&)>& name) {
  std::vector<std::string> names;
  for (const StudyCell& cell : study.cells) {
    const std::string of_cell = name(cell);
    if (of_cell.empty() || std::find(names.begin(), names.end(), of_cell) != names.end()) continue;
    names.push_back(of_cell);
  }
  return names;
}

}  // namespace

const SystemKind& system_of(const StudyFile& study) {
  return system_kind(study.cells[0].system.name);
}

std::string place_of(const StudyFile& study, const std::string& key) {
  auto line = study.lines.find(key);
  if (line == study.lines.end()) line = study.lines.find(key.substr(0, key.find('.')));
  return line == study.lines.end() ? study.place : fmt::format("{}:{}", study.place, line->second);
}

std::vector<std::string> worlds_of(const StudyFile& study) {
  return named_by_cells(study, [](const StudyCell& cell) { return cell.world; });
}

std::vector<std::string> told_rigs_of(const StudyFile& study) {
  return named_by_cells(study, [](const StudyCell& cell) {
    return cell.told.truth.empty() ? std::string() : cell.told.file;
  });
}

std::string swept_value(const StudyCell& cell, std::string_view key) {
  const auto found = std::find_if(cell.swept.begin(), cell.swept.end(),
                                  [&](const auto& entry) { return entry.first == key; });
  return found == cell.swept.end() ? std::string() : found->second;
}

int block_size(int trials) { return std::clamp(trials / fewest_maps, 1, 50); }

int independent_block_size(int trials) { return std::clamp(trials / 30, 1, 10); }

StudyFile parse_study(const std::string& text,
                      const std::string& place,
                      const std::filesystem::path& sources) {
  return StudyReader(place).read(parse_toml(text, place), sources);
}

StudyFile read_study(const std::filesystem::path& file, const std::filesystem::path& sources) {
  return parse_study(read_whole(file), file.string(), sources);
}

}  // namespace vernier::sim::internal
