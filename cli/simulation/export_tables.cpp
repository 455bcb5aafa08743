// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/export_tables.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/column_file.h"
#include "calib/base/file_in_progress.h"
#include "calib/base/text_lines.h"
#include "calib/error.h"
#include "calib/interval.h"
#include "cli/program/text_table.h"
#include "cli/simulation/study_folder.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "sim/experiment.h"
#include "sim/study/cell_summary.h"
#include "sim/study/store_rows.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/system_kind.h"

namespace vernier::cli {
namespace {

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

/// Columns of a table and, for one of its rows, their values.
class Row {
 public:
  void real(const std::string& name, double value) { add(name, ColumnKind::real, value); }
  void whole(const std::string& name, std::int64_t value) { add(name, ColumnKind::whole, value); }
  void flag(const std::string& name, bool value) { add(name, ColumnKind::boolean, value); }
  void text(const std::string& name, const std::string& value, std::size_t characters) {
    add(name, ColumnKind::text, value);
    columns.back().characters = characters;
  }
  void add(const std::string& name, ColumnKind kind, ColumnValue value) {
    columns.push_back({name, kind});
    values.push_back(std::move(value));
  }

  std::vector<Column> columns;
  std::vector<ColumnValue> values;
};

/// Settings as columns of the cells: numbers where all cells have a number.
class SettingColumns {
 public:
  /// Those that are swept, or all.
  SettingColumns(const Study& study, bool all_settings) {
    for (const StudyCell& cell : study.file.cells) {
      for (const auto& [key, value] : cell.swept) add_key(key);
      if (!all_settings) continue;
      for (const auto& [key, value] : cell.settings) add_key(key);
    }
    for (const std::string& key : keys_) {
      Setting& setting = settings_.emplace_back();
      for (const StudyCell& cell : study.file.cells) setting.values.push_back(value_of(cell, key));
      setting.is_number =
          std::all_of(setting.values.begin(), setting.values.end(), [](const std::string& value) {
            return value.empty() || (!is_beyond_double(value) && to_finite(value).has_value());
          });
      setting.characters = longest(setting.values);
    }
  }

  void add_to(Row& row, std::size_t cell) const {
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      const Setting& setting = settings_[k];
      const std::string& value = setting.values[cell];
      if (setting.is_number) {
        row.add(keys_[k], ColumnKind::real, to_finite(value).value_or(no_number));
      } else {
        row.text(keys_[k], value, setting.characters);
      }
    }
  }

  static std::size_t longest(const std::vector<std::string>& texts) {
    std::size_t most = 1;
    for (const std::string& text : texts) most = std::max(most, text_width(text));
    return most;
  }

 private:
  void add_key(const std::string& key) {
    if (std::find(keys_.begin(), keys_.end(), key) == keys_.end()) keys_.push_back(key);
  }
  /// As it is in effect, or as the sweep has it; empty if the cell has no such setting.
  static std::string value_of(const StudyCell& cell, const std::string& key) {
    if (std::string swept = swept_value(cell, key); !swept.empty()) return swept;
    const auto found = cell.settings.find(key);
    return found == cell.settings.end() ? std::string() : found->second;
  }

  /// A setting's values by cell.
  struct Setting {
    std::vector<std::string> values;
    bool is_number = false;  ///< in all cells that have one
    std::size_t characters = 1;
  };
  std::vector<std::string> keys_;
  std::vector<Setting> settings_;  // by key
};

void add_interval(Row& row, const std::string& name, const std::optional<Interval>& interval) {
  row.real(name + "_low", interval ? interval->low : no_number);
  row.real(name + "_high", interval ? interval->high : no_number);
}

/// What cells of all systems have. Those without trials have no rates and times.
class CellColumns {
 public:
  CellColumns(Row& row, const CellSummary& summary)
      : row_(row), s_(summary), of_(summary.trials > 0 ? 1 : no_number) {}

  void rate(const std::string& name, double value) { row_.real(name, of_ * value); }

  void add_success(const std::string& blocks) {
    row_.whole("trials", s_.trials);
    row_.whole(blocks, s_.maps);
    rate("success", s_.success);
    add_interval(row_, "success", s_.success_interval_95);
    add_interval(row_, "success_binomial",
                 s_.trials > 0 ? std::optional(s_.success_interval_binomial_95) : std::nullopt);
    rate("coverage", s_.coverage);
    rate("success_when_answered", s_.success_when_answered);
  }

  void add_times() {
    rate("cpu_ms_mean", s_.cpu_ms_mean);
    row_.real("cpu_ms_median", s_.cpu_ms_median);
    row_.real("cpu_ms_p95", s_.cpu_ms_p95);
    rate("wall_ms_mean", s_.wall_ms_mean);
  }

 private:
  Row& row_;
  const CellSummary& s_;
  double of_;
};

/// Of another system than a localiser.
void add_system_figures(Row& row, const CellResult& cell) {
  const CellSummary& s = cell.summary;
  const SystemSettings& system = cell.cell.system;
  CellColumns columns(row, s);
  columns.add_success("blocks");
  row.whole("failed", s.failed);
  row.whole("unsure", s.unsure);
  const std::string& error = system_kind(system.name).error_name;
  row.real("median_" + error, s.median_error);
  row.real("p95_" + error, s.p95_error);
  for (std::size_t i = 0; i < system.measured_names.size(); ++i) {
    const MeasuredSummary m = i < s.measured.size() ? s.measured[i] : MeasuredSummary{};
    row.real("mean_" + system.measured_names[i], m.mean);
    row.real("rms_" + system.measured_names[i], m.rms);
    row.real("median_" + system.measured_names[i], m.median);
  }
  columns.add_times();
}

void add_localisation_figures(Row& row, const CellResult& cell) {
  const CellSummary& s = cell.summary;
  CellColumns columns(row, s);
  columns.add_success("maps");
  columns.rate("best_guess_success", s.best_guess_success);
  row.whole("failed", s.failed);
  columns.rate("node_success", s.node_success);
  columns.rate("recall_0_5m_5deg", s.recall_05);
  columns.rate("recall_0_25m_2deg", s.recall_025);
  row.real("median_error_m", s.median_error);
  row.real("median_heading_error_deg", s.median_heading_error_rad * 180 / std::numbers::pi);
  columns.add_times();
  const std::optional<WorldCeiling>& ceiling = cell.ceiling;
  row.real("world_ceiling", ceiling ? ceiling->success : no_number);
  add_interval(row, "world_ceiling",
               ceiling ? std::optional(ceiling->success_interval_95) : std::nullopt);
  row.real("unaliased_share", ceiling ? ceiling->unaliased : no_number);
}

void add_figures(Row& row, const CellResult& cell) {
  if (cell.cell.system.is_localiser()) {
    add_localisation_figures(row, cell);
  } else {
    add_system_figures(row, cell);
  }
}

void add_pose(Row& row, const std::string& name, const Pose2D& pose, bool is_known) {
  row.real(name + "_x_m", is_known ? pose.x_m : no_number);
  row.real(name + "_y_m", is_known ? pose.y_m : no_number);
  row.real(name + "_heading_rad", is_known ? pose.heading_rad : no_number);
}

void add_trial(Row& row, const TrialResult& t) {
  constexpr std::size_t longest_status = 15;
  const bool has_answer = std::isfinite(t.error);
  row.whole("trial", t.trial);
  row.text("status", std::string(name(t.status)), longest_status);
  row.flag("answered", t.answered());
  row.flag("success", t.success());
  add_pose(row, "true", t.truth, true);
  add_pose(row, "answer", t.answer, has_answer);
  add_pose(row, "node", t.node, has_answer);
  row.real("error_m", t.error);
  row.real("node_error_m", t.node_error_m);
  row.real("heading_error_rad", t.heading_error_rad);
  row.whole("lines", t.lines);
  row.whole("looks", t.looks);
  row.whole("corners", t.corners);
  row.whole("corner_mismatches", t.corner_mismatches);
  row.real("score", t.score);
  row.real("runner_up", t.runner_up);
  row.real("probability", t.probability);
  row.real("cpu_ms", t.cpu_ms);
  row.real("wall_ms", t.wall_ms);
}

/// Of another system than a localiser.
void add_system_trial(Row& row, const SystemSettings& system, const TrialResult& t) {
  constexpr std::size_t longest_status = 15;
  row.whole("trial", t.trial);
  row.text("status", std::string(name(t.status)), longest_status);
  row.flag("answered", t.answered());
  row.flag("success", t.success());
  row.real(system_kind(system.name).error_name, t.error);
  for (std::size_t i = 0; i < system.measured_names.size(); ++i) {
    row.real(system.measured_names[i], t.measured ? (*t.measured)[i] : no_number);
  }
  row.real("cpu_ms", t.cpu_ms);
  row.real("wall_ms", t.wall_ms);
  row.text("reason", t.failure, longest_reason);
}

Row trial_row(const Study& study,
              const SettingColumns& settings,
              std::size_t cell,
              int block,
              const TrialResult& trial) {
  Row row;
  row.whole("cell", static_cast<std::int64_t>(cell) + 1);
  settings.add_to(row, cell);
  row.whole("block", block);
  const SystemSettings& system = study.file.cells[cell].system;
  if (system.is_localiser()) {
    add_trial(row, trial);
  } else {
    add_system_trial(row, system, trial);
  }
  return row;
}

}  // namespace

std::size_t export_cells(const Study& study,
                         const StudyResults& results,
                         bool all_settings,
                         const std::string& name,
                         FileInProgress& file) {
  const SettingColumns settings(study, all_settings);
  std::vector<std::string> labels;
  for (const StudyCell& cell : study.file.cells) labels.push_back(cell.label);
  std::vector<Row> rows;
  for (std::size_t i = 0; i < results.cells.size(); ++i) {
    Row& row = rows.emplace_back();
    row.whole("cell", static_cast<std::int64_t>(i) + 1);
    row.text("label", labels[i], SettingColumns::longest(labels));
    settings.add_to(row, i);
    add_figures(row, results.cells[i]);
  }
  ColumnFile table(file, ColumnFile::format_of(name), rows[0].columns, rows.size());
  for (const Row& row : rows) table.add(row.values);
  return rows.size();
}

StudyResults export_trials(const Study& study,
                           const std::filesystem::path& folder,
                           const std::string& name,
                           FileInProgress& file) {
  const ColumnFile::Format format = ColumnFile::format_of(name);
  std::size_t rows = 0;
  if (format == ColumnFile::Format::npy) {  // its head has the number of rows
    visit_results(study, folder, [&](std::size_t, const std::vector<TrialResult>& trials) {
      rows += trials.size();
    });
  }
  const SettingColumns settings(study, false);
  ColumnFile table(file, format, trial_row(study, settings, 0, 0, {}).columns, rows);
  std::size_t written = 0;
  StudyResults results =
      visit_results(study, folder, [&](std::size_t cell, const std::vector<TrialResult>& trials) {
        for (const TrialResult& t : trials) {
          const int block = static_cast<int>(t.trial) / study.file.trials_per_block;
          table.add(trial_row(study, settings, cell, block, t).values);
        }
        written += trials.size();
      });
  if (format == ColumnFile::Format::npy && written != rows) {
    throw Error(folder.string(), "is being changed by another process",
                "run the same command again when that has ended");
  }
  return results;
}

}  // namespace vernier::cli
