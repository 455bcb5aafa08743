// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/study_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/shown_text.h"
#include "calib/covariance.h"
#include "calib/interval.h"
#include "calib/rig_estimate.h"
#include "cli/program/text_table.h"
#include "cli/simulation/study_folder.h"
#include "cli/simulation/system_table.h"
#include "sim/experiment.h"
#include "sim/study/budget.h"
#include "sim/study/cell_comparison.h"
#include "sim/study/cell_summary.h"
#include "sim/study/instruction_sets.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/system_kind.h"
#include "sim/study/told_settings.h"
#include "sim/study/world_summary.h"
#include "sim/told/fresh_calibrations.h"

namespace vernier::cli {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string interval_text(const std::optional<Interval>& interval) {
  if (!interval) return "none";
  return fmt::format("[{:>5.2f}, {:>6.2f}]", 100 * interval->low, 100 * interval->high);
}

/// A number, a dash where there is none: shards have a part of a ceiling's queries each, and a cell
/// without trials or answers has no times or errors.
std::string figure(double value, int digits) {
  return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, digits);
}

std::string p_text(double p) {
  if (std::isnan(p)) return "-";
  return p < 0.0001 ? "<0.0001" : fmt::format("{:.4f}", p);
}

/// Names of the rows: the number of a cell, by which comparisons refer to it, and its swept values.
std::vector<TextColumn> key_columns(const StudyResults& results) {
  std::vector<TextColumn> columns;
  if (results.cells.size() < 2) return columns;
  columns.push_back({"cell", {}, true});
  for (std::size_t i = 0; i < results.cells.size(); ++i) {
    columns[0].cells.push_back(fmt::format("{}", i + 1));
  }
  const std::vector<std::string> keys = swept_keys(results);
  for (const std::string& key : keys) {
    columns.push_back({short_key(key, keys), {}, true});
    for (const CellResult& cell : results.cells) {
      columns.back().cells.push_back(swept_value(cell.cell, key));
    }
  }
  return columns;
}

struct CellFigures {
  std::vector<CellSummary> summaries;
  std::vector<std::optional<WorldCeiling>> ceilings;
};

bool is_same(const std::optional<WorldCeiling>& a, const std::optional<WorldCeiling>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->success == b->success && a->unaliased == b->unaliased && a->queries == b->queries;
}

bool is_shared(const std::vector<std::optional<WorldCeiling>>& ceilings) {
  return std::all_of(ceilings.begin(), ceilings.end(),
                     [&](const auto& ceiling) { return is_same(ceiling, ceilings[0]); });
}

/// One column of figures: its head and the text of a cell's figure.
template <class Text>
void add_column(std::vector<TextColumn>& columns,
                const std::string& head,
                std::size_t cells,
                Text text) {
  columns.push_back({head, {}});
  for (std::size_t i = 0; i < cells; ++i) columns.back().cells.push_back(text(i));
}

std::string cells_table(const StudyResults& results, const CellFigures& figures) {
  std::vector<TextColumn> columns = key_columns(results);
  const auto add = [&](const std::string& head, auto text) {
    add_column(columns, head, figures.summaries.size(), [&](std::size_t i) {
      const CellSummary& s = figures.summaries[i];
      return text(s, s.trials > 0 ? 1 : nan);
    });
  };
  const auto add_ceiling = [&](const std::string& head, auto text) {
    add_column(columns, head, figures.ceilings.size(), [&](std::size_t i) {
      const std::optional<WorldCeiling>& ceiling = figures.ceilings[i];
      return ceiling ? text(*ceiling) : std::string("-");
    });
  };
  using S = const CellSummary&;
  add("trials", [](S s, double) { return fmt::format("{}", s.trials); });
  add("success %", [](S s, double of) { return figure(of * 100 * s.success, 2); });
  add("95 % interval", [](S s, double) { return interval_text(s.success_interval_95); });
  add("answered %", [](S s, double of) { return figure(of * 100 * s.coverage, 1); });
  add("of these %", [](S s, double of) { return figure(of * 100 * s.success_when_answered, 2); });
  const SystemKind& kind = system_kind(results.cells[0].cell.system.name);
  add(fmt::format("median {}", kind.unit.empty() ? "error" : kind.unit), [&](S s, double) {
    return kind.make ? significant(s.median_error) : figure(s.median_error, 3);
  });
  if (kind.make) {
    add(fmt::format("p95 {}", kind.unit.empty() ? "error" : kind.unit),
        [](S s, double) { return significant(s.p95_error); });
  }
  add("cpu ms", [](S s, double of) { return figure(of * s.cpu_ms_mean, 1); });
  add("p95 ms", [](S s, double) { return figure(s.cpu_ms_p95, 1); });
  if (results.cells[0].interval_width) {
    add_column(columns, kind.make ? "blocks" : "maps", results.cells.size(),
               [&](std::size_t i) { return fmt::format("{}", results.cells[i].maps.size()); });
    add_column(columns, "stopped", results.cells.size(),
               [&](std::size_t i) { return std::string(name(results.cells[i].budget.state)); });
  }
  if (!is_shared(figures.ceilings)) {
    using C = const WorldCeiling&;
    add_ceiling("ceiling %", [](C c) { return figure(100 * c.success, 1); });
    add_ceiling("of the ceiling", [](C c) { return interval_text(c.success_interval_95); });
    add_ceiling("unaliased %", [](C c) { return figure(100 * c.unaliased, 1); });
  }
  return text_table(std::move(columns));
}

std::string shared_ceiling(const CellFigures& figures, const StudyResults& results) {
  if (!is_shared(figures.ceilings) || !figures.ceilings[0]) return {};
  const WorldCeiling& c = *figures.ceilings[0];
  const bool is_usual = std::all_of(
      results.cells.begin(), results.cells.end(),
      [](const CellResult& cell) { return cell.cell.system.success_error == success_radius_m; });
  return fmt::format("world ceiling{} {:.1f} % {}, unaliased {:.1f} % of the queries\n",
                     is_usual ? "" : fmt::format(" (within {:g} m)", success_radius_m),
                     100 * c.success, interval_text(c.success_interval_95), 100 * c.unaliased);
}

/// Whether a cell's success lies above its ceiling by more than chance.
bool exceeds_ceiling(const CellSummary& s, const std::optional<WorldCeiling>& ceiling) {
  return ceiling && s.success_interval_95 &&
         s.success_interval_95->low > ceiling->success_interval_95.high;
}

std::string ceiling_line(const CellFigures& figures, const StudyResults& results) {
  std::string text = shared_ceiling(figures, results);
  for (std::size_t i = 0; i < figures.summaries.size(); ++i) {
    if (!exceeds_ceiling(figures.summaries[i], figures.ceilings[i])) continue;
    return text +
           "success exceeds the ceiling, which is of one look, by lines without corners, and "
           "counts "
           "views that fit poses in a continuum as wrong\n";
  }
  return text;
}

std::string worlds_table(const StudyResults& results) {
  const std::vector<WorldSummary> worlds = summarise_over_worlds(results.cells);
  if (worlds.empty()) return {};
  std::vector<TextColumn> columns{{"over worlds", {}, true}};
  for (const WorldSummary& s : worlds) columns[0].cells.push_back(s.label);
  const auto add = [&](const std::string& head, auto text) {
    add_column(columns, head, worlds.size(), [&](std::size_t i) { return text(worlds[i]); });
  };
  using S = const WorldSummary&;
  add("worlds", [](S s) { return fmt::format("{}", s.worlds); });
  add("success %", [](S s) { return s.worlds > 0 ? figure(100 * s.success, 2) : "-"; });
  add("95 % interval", [](S s) { return interval_text(s.success_interval_95); });
  return "\n" + text_table(std::move(columns));
}

/// The comparisons that have a p-value.
std::string comparisons_table(const StudyResults& results) {
  std::vector<AdjustedComparison> pairs = compare_all(results.cells);
  std::erase_if(pairs, [](const auto& pair) { return std::isnan(pair.paired.p_value); });
  if (pairs.empty()) return {};
  const bool localiser = results.cells[0].cell.system.is_localiser();
  std::vector<TextColumn> columns;
  const auto add = [&](const std::string& head, auto text) {
    add_column(columns, head, pairs.size(), [&](std::size_t i) { return text(pairs[i]); });
  };
  using P = const AdjustedComparison&;
  add("cells", [](P p) { return fmt::format("{}, {}", p.a + 1, p.b + 1); });
  columns[0].is_key = true;
  add("only first right", [](P p) { return fmt::format("{}", p.paired.only_a); });
  add("only second", [](P p) { return fmt::format("{}", p.paired.only_b); });
  add("p", [](P p) { return p_text(p.paired.p_value); });
  add("p by Holm", [](P p) { return p_text(p.p_holm); });
  return fmt::format("\nsame {}, by a paired t-test over {}:\n", localiser ? "queries" : "trials",
                     localiser ? "maps" : "blocks") +
         text_table(std::move(columns));
}

std::string world_names(const Study& study) {
  std::vector<std::string> names;
  for (const std::string& file : worlds_of(study.file)) {
    names.push_back(file == study.file.world ? study.world.name
                                             : study.other_worlds.at(file).world.name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

/// What the estimator is told of the true rig.
std::string rig_text(const Study& study) {
  const auto covariance = [](const RigEstimate& rig) {
    return rig.covariance
               ? fmt::format("covariance (scaled by psi_c) of kind {}", name(rig.covariance->kind))
               : std::string("no covariance");
  };
  const ToldSettings& told = study.file.cells[0].told;
  if (told.calibration) {
    return fmt::format("true rig {}; told: a fresh calibration for each trial{}\n", study.file.rig,
                       study.file.cells[0].system.is_localiser() ? " and each map" : "");
  }
  if (told.truth.empty()) {
    return fmt::format("rig {}: {}\n", study.file.rig, covariance(study.rig));
  }
  std::string text = fmt::format("true rig {}\n", study.file.rig);
  std::set<std::string> said;
  for (const StudyCell& cell : study.file.cells) {
    const std::string& file = cell.told.file;
    const std::string line = fmt::format("told rig {}: {}\n", file,
                                         cell.told.error == ToldSettings::Error::given
                                             ? "as given, its error scaled by psi_c"
                                             : covariance(study.told_rigs.at(file).estimate));
    if (said.insert(line).second) text += line;
  }
  return text;
}

/// What became of the calibrations of the cells with [calibration], each once.
std::string calibrations_text(const StudyResults& results) {
  std::string text;
  std::set<std::string> said;
  for (const CellResult& cell : results.cells) {
    if (!cell.calibrations) continue;
    const CalibrationRecord& c = *cell.calibrations;
    const ToldSettings& told = cell.cell.told;
    std::string line = fmt::format("calibrations from {}{}: {} of {} failed, {} more are doubted",
                                   counted(told.calibration->views, "view"),
                                   told.model.empty() ? "" : " as " + told.model, c.failed,
                                   c.calibrations, c.doubtful);
    if (std::isfinite(c.depth_error_m)) {
      line += fmt::format("; depth at {:g} m at psi_c = 1: rms error {:.3g} m, stated {:.3g} m",
                          c.range_m, c.depth_error_m, c.depth_sd_m);
    }
    line += "\n";
    if (!said.insert(line).second) continue;  // cells share calibrations
    text += line;
    if (!c.why_failed.empty()) text += fmt::format("  failed: {}\n", c.why_failed);
    if (!c.why_doubtful.empty()) text += fmt::format("  doubted: {}\n", c.why_doubtful);
  }
  return text;
}

std::string conditions(const Study& study, const StudyResults& results) {
  if (!results.cells[0].cell.system.is_localiser()) {
    const bool with_rigs = uses_told_rigs(system_of(study.file));
    return (with_rigs ? rig_text(study) : fmt::format("true rig {}\n", study.file.rig)) +
           calibrations_text(results) + system_conditions(study, world_names(study));
  }
  const std::vector<std::string> keys = swept_keys(results);
  const bool swept_protocol = std::find(keys.begin(), keys.end(), "study.protocol") != keys.end();
  const auto protocol = name(study.file.cells[0].experiment.protocol);
  return rig_text(study) + calibrations_text(results) +
         fmt::format("{}world {}; success: answered, within {}\n",
                     swept_protocol ? "" : fmt::format("protocol {}, ", protocol),
                     world_names(study), limit_text(study.file)) +
         (study.file.interval_width
              ? fmt::format("interval: confidence sequence over recorded maps, to {} wide\n",
                            *study.file.interval_width)
              : "interval: Wilson's with Student's t, clustered by recorded map\n");
}

}  // namespace

std::vector<std::string> swept_keys(const StudyResults& results) {
  std::vector<std::string> keys;
  for (const CellResult& cell : results.cells) {
    for (const auto& [key, value] : cell.cell.swept) {
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
    }
  }
  return keys;
}

std::string short_key(const std::string& key, const std::vector<std::string>& keys) {
  const auto last = [](const std::string& k) { return k.substr(k.rfind('.') + 1); };
  const bool single = std::count_if(keys.begin(), keys.end(), [&](const std::string& other) {
                        return last(other) == last(key);
                      }) == 1;
  return single ? last(key) : key;
}

std::string study_table(const Study& study, const StudyResults& results) {
  CellFigures figures;
  std::set<std::string> missing;
  for (const CellResult& cell : results.cells) {
    figures.summaries.push_back(cell.summary);
    figures.ceilings.push_back(cell.ceiling);
    const CellSummary& s = figures.summaries.back();
    if (!s.success_interval_95) missing.insert(s.why_no_interval);
  }
  std::string text = cells_table(results, figures) + measured_table(results, key_columns(results)) +
                     worlds_table(results) + comparisons_table(results) + "\n" +
                     ceiling_line(figures, results) + conditions(study, results);
  for (const std::string& why : missing) text += fmt::format("no interval: {}\n", why);
  if (is_mixture(results.instruction_sets)) {
    text += fmt::format("computed with instruction sets {}: not comparable to the bit\n",
                        results.instruction_sets);
  }
  if (results.blocks_done == 0) text += "no trials are stored yet\n";
  if (results.blocks_done < results.blocks_total) {
    text += fmt::format(
        "{} of {} blocks done: run the study again to finish it{}\n", results.blocks_done,
        results.blocks_total,
        results.missing_shards.empty() ? "" : ", with " + shard_options(results.missing_shards));
  }
  return text;
}

}  // namespace vernier::cli
