// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/study_folder.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/text_lines.h"
#include "calib/covariance.h"
#include "calib/interval.h"
#include "calib/rig_estimate.h"
#include "calib/statistics/distributions.h"
#include "cli/program/session.h"
#include "sim/experiment.h"
#include "sim/study/cell_comparison.h"
#include "sim/study/cell_summary.h"
#include "sim/study/reliability.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/told_settings.h"
#include "sim/told/fresh_calibrations.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

/// A setting as a JSON number, Boolean or string.
Json value_json(const std::string& text) {
  if (text == "true" || text == "false") return text == "true";
  const std::optional<double> value = to_real(text);
  return value ? Json(*value) : Json(text);
}

/// Stated against observed error rates; empty for a method that states none.
Json reliability_json(const std::vector<TrialResult>& trials) {
  Json json = Json::array();
  for (const ReliabilityBin& bin : reliability(trials)) {
    json.push_back({{"stated_error", bin.stated_error},
                    {"error", static_cast<double>(bin.wrong) / bin.answers},
                    {"error_interval_95", {bin.error_interval_95.low, bin.error_interval_95.high}},
                    {"answers", bin.answers},
                    {"wrong", bin.wrong}});
  }
  return json;
}

/// Coverage and errors at thresholds of the stated error rate.
Json thresholds_json(const std::vector<TrialResult>& trials) {
  Json json = Json::array();
  for (const ThresholdFigures& at : thresholds(trials)) {
    json.push_back({{"max_error_rate", at.max_error_rate},
                    {"coverage", at.coverage},
                    {"answered", at.answered},
                    {"wrong", at.wrong}});
  }
  return json;
}

/// The rigs of a study, with the kind of covariance that psi_c scales; null if there is none.
Json rig_json(const Study& study) {
  const auto kind = [](const RigEstimate& rig) {
    return rig.covariance ? Json(name(rig.covariance->kind)) : Json();
  };
  Json json{{"file", study.file.rig}, {"covariance_kind", kind(study.rig)}};
  for (const std::string& file : told_rigs_of(study.file)) {
    json["told"].push_back(
        {{"file", file}, {"covariance_kind", kind(study.told_rigs.at(file).estimate)}});
  }
  return json;
}

/// What became of the calibrations of a cell; null without any.
Json calibrations_json(const std::optional<CalibrationRecord>& record) {
  if (!record) return {};
  return {{"calibrations", record->calibrations},
          {"failed", record->failed},
          {"doubtful", record->doubtful},
          {"why_failed", record->why_failed},
          {"why_doubtful", record->why_doubtful},
          {"range_m", record->range_m},
          {"depth_error_m", json_number(record->depth_error_m)},
          {"depth_sd_m", json_number(record->depth_sd_m)}};
}

}  // namespace

std::string short_label(const StudyCell& cell) {
  std::string label = cell.label;
  const std::string key = "sources.calibration";
  if (const std::size_t at = label.find(key); at != std::string::npos) {
    label.replace(at, key.size(), "ψ_c");
  }
  return label;
}

Json cell_json(const CellResult& cell) {
  const CellSummary s = summarise(cell);
  Json settings;
  for (const auto& [key, value] : cell.cell.settings) settings[key] = value_json(value);
  const auto pair = [](const Interval& i) { return Json{i.low, i.high}; };
  // A cell without trials has no rates and times.
  const auto of_trials = [&](double value) { return s.trials > 0 ? json_number(value) : Json(); };
  const Json clustered = s.success_interval_95 ? pair(*s.success_interval_95) : Json();
  const Json missing = s.success_interval_95 ? Json() : Json(s.why_no_interval);
  return {{"label", short_label(cell.cell)},
          {"settings", settings},
          {"trials", s.trials},
          {"success", of_trials(s.success)},
          {"maps", s.maps},
          {"success_interval_95", clustered},
          {"success_interval_95_missing", missing},
          {"success_interval_binomial_95",
           s.trials > 0 ? pair(s.success_interval_binomial_95) : Json()},
          {"coverage", of_trials(s.coverage)},
          {"success_when_answered", of_trials(s.success_when_answered)},
          {"best_guess_success", of_trials(s.best_guess_success)},
          {"failed", s.failed},
          {"node_success", of_trials(s.node_success)},
          {"recall_0_5m_5deg", of_trials(s.recall_05)},
          {"recall_0_25m_2deg", of_trials(s.recall_025)},
          {"median_error_m", json_number(s.median_error_m)},
          {"median_heading_error_deg",
           json_number(s.median_heading_error_rad * 180 / std::numbers::pi)},
          {"cpu_ms_mean", of_trials(s.cpu_ms_mean)},
          {"cpu_ms_median", json_number(s.cpu_ms_median)},
          {"cpu_ms_p95", json_number(s.cpu_ms_p95)},
          {"wall_ms_mean", of_trials(s.wall_ms_mean)},
          {"protocol", name(cell.cell.experiment.protocol)},
          {"world_ceiling", cell.ceiling ? Json(cell.ceiling->success) : Json()},
          {"world_ceiling_interval_95",
           cell.ceiling ? pair(cell.ceiling->success_interval_95) : Json()},
          {"world_ceiling_queries", cell.ceiling ? Json(cell.ceiling->queries) : Json()},
          {"unaliased_share", cell.ceiling ? Json(cell.ceiling->unaliased) : Json()},
          {"unaliased_share_interval_95",
           cell.ceiling ? pair(cell.ceiling->unaliased_interval_95) : Json()},
          {"reliability", reliability_json(cell.trials)},
          {"thresholds", cell.cell.experiment.looks == 1 ? thresholds_json(cell.trials) : Json()},
          {"calibration", calibrations_json(cell.calibrations)}};
}

Json comparisons_json(const StudyResults& results) {
  Json comparisons = Json::array();
  const std::vector<std::pair<std::size_t, std::size_t>> pairs = comparable_pairs(results.cells);
  std::vector<PairedComparison> compared;
  std::vector<double> p_values;
  for (const auto& [a, b] : pairs) {
    compared.push_back(compare(results.cells[a], results.cells[b]));
    p_values.push_back(compared.back().p_value);
  }
  const std::vector<double> adjusted = holm_adjusted(p_values);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& [a, b] = pairs[i];
    const PairedComparison& c = compared[i];
    comparisons.push_back({{"a", short_label(results.cells[a].cell)},
                           {"b", short_label(results.cells[b].cell)},
                           {"both", c.both},
                           {"only_a", c.only_a},
                           {"only_b", c.only_b},
                           {"neither", c.neither},
                           {"maps", c.maps},
                           {"test", "paired t over maps"},
                           {"p_value", json_number(c.p_value)},
                           {"p_value_holm", json_number(adjusted[i])},
                           {"mcnemar_p", json_number(c.mcnemar_p)}});
  }
  return comparisons;
}

Json study_json(const Study& study, const StudyResults& results) {
  Json json{{"trials", study.file.trials},
            {"rig", rig_json(study)},
            {"blocks_done", results.blocks_done},
            {"blocks_total", results.blocks_total},
            {"cells", Json::array()}};
  for (const CellResult& cell : results.cells) json["cells"].push_back(cell_json(cell));
  json["comparisons"] = comparisons_json(results);
  return json;
}

namespace {

std::string interval_text(const std::optional<Interval>& interval) {
  if (!interval) return "none";
  return fmt::format("[{:>5.2f}, {:>6.2f}]", 100 * interval->low, 100 * interval->high);
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
    return fmt::format("true rig {}; told: a fresh calibration for each trial and each map\n",
                       study.file.rig);
  }
  if (told.truth.empty()) {
    return fmt::format("rig {}: {}\n", study.file.rig, covariance(study.rig));
  }
  std::string text = fmt::format("true rig {}\n", study.file.rig);
  for (const std::string& file : told_rigs_of(study.file)) {
    text += fmt::format("told rig {}: {}\n", file, covariance(study.told_rigs.at(file).estimate));
  }
  return text;
}

/// A line for each cell with [calibration].
std::string calibrations_text(const StudyResults& results) {
  std::string text;
  for (const CellResult& cell : results.cells) {
    if (!cell.calibrations) continue;
    const CalibrationRecord& c = *cell.calibrations;
    text += fmt::format(
        "calibrations from {} views: {} of {} failed, {} more are doubted; depth at {:g} m: rms "
        "error {:.3g} m, stated {:.3g} m\n",
        cell.cell.told.calibration->views, c.failed, c.calibrations, c.doubtful, c.range_m,
        c.depth_error_m, c.depth_sd_m);
    if (!c.why_failed.empty()) text += fmt::format("  failed: {}\n", c.why_failed);
    if (!c.why_doubtful.empty()) text += fmt::format("  doubted: {}\n", c.why_doubtful);
  }
  return text;
}

/// A number with its unit, a dash where there is none: shards have a part of a ceiling's queries
/// each, and a cell without trials or answers has no times or errors.
std::string figure(double value, int digits, const char* unit = "") {
  return std::isnan(value) ? "-" : fmt::format("{:.{}f}{}", value, digits, unit);
}

}  // namespace

std::string study_table(const Study& study, const StudyResults& results) {
  const bool swept = !study.file.sweep_keys.empty();
  std::string text =
      fmt::format("{:<24} {:>6} {:>8} {:>15} {:>8} {:>9} {:>8} {:>15} {:>9} {:>9} {:>9} {:>9}\n",
                  swept ? "cell" : "", "trials", "success", "95 % interval", "answered", "of these",
                  "ceiling", "95 % interval", "unaliased", "median m", "cpu ms", "p95 ms");
  std::set<std::string> missing;
  for (const CellResult& cell : results.cells) {
    const CellSummary s = summarise(cell);
    if (!s.success_interval_95) missing.insert(s.why_no_interval);
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    const double of_trials = s.trials > 0 ? 1 : nan;
    text += fmt::format(
        "{:<24} {:>6} {:>8} {:>15} {:>8} {:>9} {:>8} {:>15} {:>9} {:>9} {:>9} {:>9}\n",
        swept ? cell.cell.label.substr(cell.cell.label.find('.') + 1) : "", s.trials,
        figure(of_trials * 100 * s.success, 2, " %"), interval_text(s.success_interval_95),
        figure(of_trials * 100 * s.coverage, 1, " %"),
        figure(of_trials * 100 * s.success_when_answered, 2, " %"),
        figure(cell.ceiling ? 100 * cell.ceiling->success : nan, 1, " %"),
        cell.ceiling ? interval_text(cell.ceiling->success_interval_95) : "-",
        figure(cell.ceiling ? 100 * cell.ceiling->unaliased : nan, 1, " %"),
        figure(s.median_error_m, 3), figure(of_trials * s.cpu_ms_mean, 1), figure(s.cpu_ms_p95, 1));
  }
  const auto& keys = study.file.sweep_keys;
  const bool swept_protocol = std::find(keys.begin(), keys.end(), "study.protocol") != keys.end();
  const auto protocol = name(study.file.cells[0].experiment.protocol);
  text += rig_text(study) + calibrations_text(results);
  text +=
      fmt::format("{}world {}; success: within 1 m; interval: Wilson, clustered by recorded map\n",
                  swept_protocol ? "" : fmt::format("protocol {}, ", protocol), world_names(study));
  for (const std::string& why : missing) text += fmt::format("no interval: {}\n", why);
  if (results.blocks_done == 0) text += "no trials are stored yet\n";
  if (results.blocks_done < results.blocks_total) {
    text += fmt::format("{} of {} blocks done: run the study again to finish it\n",
                        results.blocks_done, results.blocks_total);
  }
  return text;
}

}  // namespace vernier::cli
