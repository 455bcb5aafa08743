// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/study_folder.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "calib/base/text_lines.h"
#include "calib/covariance.h"
#include "calib/interval.h"
#include "calib/rig_estimate.h"
#include "calib/statistics/distributions.h"
#include "cli/program/session.h"
#include "cli/simulation/study_inputs.h"
#include "sim/experiment.h"
#include "sim/study/budget.h"
#include "sim/study/cell_comparison.h"
#include "sim/study/cell_summary.h"
#include "sim/study/reliability.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_store.h"
#include "sim/study/system_kind.h"
#include "sim/study/told_settings.h"
#include "sim/study/world_summary.h"
#include "sim/told/fresh_calibrations.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

/// Stated against observed error rates; empty for a method that states none.
Json reliability_json(const StatedErrors& stated) {
  Json json = Json::array();
  for (const ReliabilityBin& bin : stated.reliability()) {
    json.push_back({{"stated_error", bin.stated_error},
                    {"error", static_cast<double>(bin.wrong) / bin.answers},
                    {"error_interval_95", {bin.error_interval_95.low, bin.error_interval_95.high}},
                    {"answers", bin.answers},
                    {"wrong", bin.wrong}});
  }
  return json;
}

/// Coverage and errors at thresholds of the stated error rate.
Json thresholds_json(const StatedErrors& stated) {
  Json json = Json::array();
  for (const ThresholdFigures& at : stated.thresholds()) {
    json.push_back({{"max_error_rate", at.max_error_rate},
                    {"coverage", at.coverage},
                    {"answered", at.answered},
                    {"wrong", at.wrong},
                    {"stated_error", at.stated_error}});
  }
  return json;
}

/// Whether the looks of a query do not depend on the threshold of its answer.
bool looks_are_apart(const ExperimentSettings& settings) {
  return settings.looks == 1 || settings.localiser.look_error_rate.has_value();
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

std::optional<std::uint64_t> to_whole(const std::string& text) {
  std::uint64_t whole = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), whole);
  if (fault != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return whole;
}

}  // namespace

bool is_beyond_double(const std::string& text) {
  constexpr std::uint64_t most_exact = std::uint64_t{1} << 53;
  return to_whole(text).value_or(0) > most_exact;
}

Json setting_json(const std::string& text) {
  if (text == "true" || text == "false") return text == "true";
  if (is_beyond_double(text)) return *to_whole(text);
  const std::optional<double> value = to_finite(text);
  return value ? Json(*value) : Json(text);
}

Json system_json(const SystemKind& kind) {
  Json measured = Json::object();
  for (const MeasuredQuantity& of : kind.measured) measured[of.name] = of.meaning;
  return {{"name", kind.name},
          {"error", kind.error_name},
          {"title", kind.error_title},
          {"unit", kind.unit},
          {"measured", measured}};
}

std::vector<fs::path> study_folder_files(const fs::path& folder) {
  std::vector<fs::path> files = store_files(folder);
  for (fs::path& file : input_files(folder)) files.push_back(std::move(file));
  return files;
}

std::string shard_options(const std::vector<Shard>& shards) {
  constexpr std::size_t most = 10;
  std::string text;
  for (std::size_t i = 0; i < std::min(most, shards.size()); ++i) {
    text += fmt::format("{}--shard {}/{}", i > 0 ? ", " : "", shards[i].index, shards[i].count);
  }
  return shards.size() > most ? text + fmt::format(" and {} more", shards.size() - most) : text;
}

std::string short_label(const StudyCell& cell) {
  std::string label = cell.label;
  const std::string key = "sources.calibration";
  if (const std::size_t at = label.find(key); at != std::string::npos) {
    label.replace(at, key.size(), "ψ_c");
  }
  return label;
}

namespace {

/// What cells of localisers have and others have not.
void add_localisation(const CellResult& cell, Json& json) {
  const CellSummary& s = cell.summary;
  const auto of_trials = [&](double value) { return s.trials > 0 ? json_number(value) : Json(); };
  const auto pair = [](const Interval& i) { return Json{i.low, i.high}; };
  json.update({{"maps", s.maps},
               {"best_guess_success", of_trials(s.best_guess_success)},
               {"node_success", of_trials(s.node_success)},
               {"recall_0_5m_5deg", of_trials(s.recall_05)},
               {"recall_0_25m_2deg", of_trials(s.recall_025)},
               {"median_error_m", json_number(s.median_error)},
               {"median_heading_error_deg",
                json_number(s.median_heading_error_rad * 180 / std::numbers::pi)},
               {"protocol", name(cell.cell.experiment.protocol)},
               {"world_ceiling", cell.ceiling ? Json(cell.ceiling->success) : Json()},
               {"world_ceiling_interval_95",
                cell.ceiling ? pair(cell.ceiling->success_interval_95) : Json()},
               {"world_ceiling_queries", cell.ceiling ? Json(cell.ceiling->queries) : Json()},
               {"unaliased_share", cell.ceiling ? Json(cell.ceiling->unaliased) : Json()},
               {"unaliased_share_interval_95",
                cell.ceiling ? pair(cell.ceiling->unaliased_interval_95) : Json()},
               {"reliability", reliability_json(cell.stated)},
               {"thresholds",
                looks_are_apart(cell.cell.experiment) ? thresholds_json(cell.stated) : Json()}});
}

/// What cells of other systems have.
void add_system(const CellResult& cell, Json& json) {
  const CellSummary& s = cell.summary;
  const SystemSettings& system = cell.cell.system;
  json["blocks"] = s.maps;
  json["median_error"] = json_number(s.median_error);
  json["p95_error"] = json_number(s.p95_error);
  json["why_failed"] = s.why_failed.empty() ? Json() : Json(s.why_failed);
  json["unsure"] = s.unsure;
  json["why_unsure"] = s.why_unsure.empty() ? Json() : Json(s.why_unsure);
  json["measured"] = Json::object();
  for (std::size_t i = 0; i < s.measured.size(); ++i) {
    const MeasuredSummary& m = s.measured[i];
    json["measured"][system.measured_names[i]] = {{"trials", m.trials},
                                                  {"mean", json_number(m.mean)},
                                                  {"rms", json_number(m.rms)},
                                                  {"median", json_number(m.median)}};
  }
}

}  // namespace

Json over_worlds_json(const StudyResults& results) {
  Json json = Json::array();
  for (const WorldSummary& s : summarise_over_worlds(results.cells)) {
    const std::optional<Interval>& interval = s.success_interval_95;
    json.push_back(
        {{"label", s.label},
         {"worlds", s.worlds},
         {"success", s.worlds > 0 ? Json(s.success) : Json()},
         {"success_interval_95", interval ? Json{interval->low, interval->high} : Json()},
         {"success_interval_95_missing", interval ? Json() : Json(s.why_no_interval)}});
  }
  return json;
}

Json cell_json(const CellResult& cell) {
  const CellSummary& s = cell.summary;
  Json settings;
  for (const auto& [key, value] : cell.cell.settings) settings[key] = setting_json(value);
  const auto pair = [](const Interval& i) { return Json{i.low, i.high}; };
  // A cell without trials has no rates and times.
  const auto of_trials = [&](double value) { return s.trials > 0 ? json_number(value) : Json(); };
  const Json clustered = s.success_interval_95 ? pair(*s.success_interval_95) : Json();
  const Json missing = s.success_interval_95 ? Json() : Json(s.why_no_interval);
  Json swept = Json::object();
  for (const auto& [key, value] : cell.cell.swept) swept[key] = setting_json(value);
  Json json{{"label", short_label(cell.cell)},
            {"settings", settings},
            {"swept", swept},
            {"trials", s.trials},
            {"success_error", cell.cell.system.success_error},
            {"success", of_trials(s.success)},
            {"success_interval_95", clustered},
            {"success_interval_95_missing", missing},
            {"interval_width_wanted", cell.interval_width ? Json(*cell.interval_width) : Json()},
            {"stopped", cell.interval_width ? Json(name(cell.budget.state)) : Json()},
            {"success_interval_binomial_95",
             s.trials > 0 ? pair(s.success_interval_binomial_95) : Json()},
            {"coverage", of_trials(s.coverage)},
            {"success_when_answered", of_trials(s.success_when_answered)},
            {"failed", s.failed},
            {"cpu_ms_mean", of_trials(s.cpu_ms_mean)},
            {"cpu_ms_median", json_number(s.cpu_ms_median)},
            {"cpu_ms_p95", json_number(s.cpu_ms_p95)},
            {"wall_ms_mean", of_trials(s.wall_ms_mean)},
            {"calibration", calibrations_json(cell.calibrations)}};
  if (cell.cell.system.is_localiser()) {
    add_localisation(cell, json);
  } else {
    add_system(cell, json);
  }
  return json;
}

Json comparisons_json(const StudyResults& results) {
  Json comparisons = Json::array();
  for (const AdjustedComparison& pair : compare_all(results.cells)) {
    const PairedComparison& c = pair.paired;
    comparisons.push_back({{"a", short_label(results.cells[pair.a].cell)},
                           {"b", short_label(results.cells[pair.b].cell)},
                           {"both", c.both},
                           {"only_a", c.only_a},
                           {"only_b", c.only_b},
                           {"neither", c.neither},
                           {"maps", c.maps},
                           {"test", "paired t over maps"},
                           {"p_value", json_number(c.p_value)},
                           {"p_value_holm", json_number(pair.p_holm)},
                           {"mcnemar_p", json_number(c.mcnemar_p)}});
  }
  return comparisons;
}

Json study_json(const Study& study, const StudyResults& results) {
  Json json{{"trials", study.file.trials},
            {"system", system_json(system_of(study.file))},
            {"rig", rig_json(study)},
            {"blocks_done", results.blocks_done},
            {"blocks_total", results.blocks_total},
            {"instruction_sets", results.instruction_sets},
            {"missing_shards", Json::array()},
            {"cells", Json::array()}};
  for (const Shard& shard : results.missing_shards) {
    json["missing_shards"].push_back(fmt::format("{}/{}", shard.index, shard.count));
  }
  for (const CellResult& cell : results.cells) json["cells"].push_back(cell_json(cell));
  json["over_worlds"] = over_worlds_json(results);
  json["comparisons"] = comparisons_json(results);
  return json;
}

}  // namespace vernier::cli
