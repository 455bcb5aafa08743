// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/study_folder.h"

#include <algorithm>
#include <cstddef>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/fingerprint.h"
#include "calib/base/text_lines.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/interval.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "sim/experiment.h"
#include "sim/study/budget.h"
#include "sim/study/cell_comparison.h"
#include "sim/study/cell_summary.h"
#include "sim/study/reliability.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_store.h"
#include "sim/study/world_summary.h"
#include "sim/world.h"
#include "sim/world_file.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

/// Throws Error for a route without or with too many views, before anything is written.
void check_maps(const Study& study) {
  std::set<std::pair<double, int>> checked;
  for (const StudyCell& cell : study.file.cells) {
    const ExperimentSettings& settings = cell.experiment;
    if (!checked.emplace(settings.map_spacing_m, settings.map_headings).second) continue;
    map_poses(study.world.route, settings.map_spacing_m, settings.map_headings);
  }
}

Study assemble(StudyFile file, const fs::path& world, const fs::path& rig, Session& session) {
  Study study;
  study.file = std::move(file);
  const std::string world_text = read_whole(world), rig_text = read_whole(rig);
  study.world = build_world(parse_world(world_text, world.string()));
  study.world_fingerprint = fingerprint(world_text);
  RigFile rig_file = parse_rig(rig_text, rig.string());
  for (const std::string& warning : rig_file.warnings) session.warn(warning);
  study.rig = std::move(rig_file.estimate);
  study.rig_fingerprint = fingerprint(rig_text);
  check_maps(study);
  for (const StudyCell& cell : study.file.cells) {
    if (cell.experiment.sources.calibration > 0) required_covariance(study.rig, rig.string());
  }
  return study;
}

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

/// Success over swept worlds; empty if there are none.
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

/// The kind of the rig's covariance, which psi_c scales; null if there is none.
Json covariance_json(const Study& study) {
  return study.rig.covariance ? Json(name(study.rig.covariance->kind)) : Json();
}

}  // namespace

Study load_study(const fs::path& file, Session& session) {
  StudyFile study = read_study(file);
  const fs::path world = find_world(study.world, file.parent_path());
  const fs::path rig = find_rig(study.rig, file.parent_path());
  return assemble(std::move(study), world, rig, session);
}

Study open_folder(const fs::path& folder, Session& session) {
  if (!fs::is_regular_file(folder / "study.toml")) {
    throw Error(folder.string(), "is not a study folder",
                "give a folder written by vernier study -o");
  }
  return assemble(read_study(folder / "study.toml", folder / "sources.toml"),
                  folder / "world.world.toml", folder / "rig.json", session);
}

std::vector<fs::path> study_folder_files(const fs::path& folder) {
  std::vector<fs::path> files = store_files(folder);
  for (const char* name : {"study.toml", "world.world.toml", "rig.json", "sources.toml"}) {
    files.push_back(folder / name);
  }
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

Json cell_json(const CellResult& cell) {
  const CellSummary s = summarise(cell);
  Json settings;
  for (const auto& [key, value] : cell.cell.settings) settings[key] = value_json(value);
  const auto pair = [](const Interval& i) { return Json{i.low, i.high}; };
  // A cell without trials has no rates and times.
  const auto of_trials = [&](double value) { return s.trials > 0 ? json_number(value) : Json(); };
  const Json clustered = s.success_interval_95 ? pair(*s.success_interval_95) : Json();
  const Json missing = s.success_interval_95 ? Json() : Json(s.why_no_interval);
  Json swept = Json::object();
  for (const auto& [key, value] : cell.cell.swept) swept[key] = value_json(value);
  return {{"label", short_label(cell.cell)},
          {"settings", settings},
          {"swept", swept},
          {"trials", s.trials},
          {"success", of_trials(s.success)},
          {"maps", s.maps},
          {"success_interval_95", clustered},
          {"success_interval_95_missing", missing},
          {"interval_width_wanted", cell.interval_width ? Json(*cell.interval_width) : Json()},
          {"stopped", cell.interval_width ? Json(name(cell.budget.state)) : Json()},
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
          {"thresholds", cell.cell.experiment.looks == 1 ? thresholds_json(cell.trials) : Json()}};
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
            {"rig", {{"file", study.file.rig}, {"covariance_kind", covariance_json(study)}}},
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
