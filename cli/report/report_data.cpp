// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/report/report_data.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/error.h"
#include "cli/program/page.h"
#include "cli/program/session.h"
#include "cli/simulation/observation_json.h"
#include "cli/simulation/study_folder.h"
#include "cli/simulation/study_table.h"
#include "localise/place.h"
#include "sim/experiment.h"
#include "sim/mount_error.h"
#include "sim/moved_furniture.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/study/cell_comparison.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/system_kind.h"
#include "sim/uncertainty_source.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "stereo/segment.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char *script_file = "report.js", *plotly_file = "plotly.js";

/// Of a study, which a page can still draw at once; of each cell its first trials.
constexpr std::size_t most_listed = 20'000;

Json trial_json(const TrialResult& t) {
  Json row{t.trial, t.truth.x_m, t.truth.y_m, t.truth.heading_rad};
  if (t.answered()) {
    row.insert(row.end(), {t.answer.x_m, t.answer.y_m, t.answer.heading_rad, t.error});
  } else {
    row.insert(row.end(), {nullptr, nullptr, nullptr, nullptr});
  }
  row.push_back(t.success() ? 1 : 0);
  return row;
}

/// Swept keys in their order, as they are called in plots.
Json swept_keys_json(const StudyResults& results) {
  Json keys = Json::array();
  const std::vector<std::string> swept = swept_keys(results);
  for (const std::string& key : swept) {
    keys.push_back(
        {{"key", key}, {"label", key == "sources.calibration" ? "ψ_c" : short_key(key, swept)}});
  }
  return keys;
}

/// What a view shows; no sensed lines if a source has failed.
std::string view_words(std::size_t visible, std::size_t sensed, const std::string& failure) {
  const std::string of_view =
      fmt::format("Left view of trial 0: {} edges visible in both cameras", visible);
  if (failure.empty()) {
    return fmt::format("{}, {} sensed after applying all error sources.", of_view, sensed);
  }
  return fmt::format("{}. What was sensed is not shown, since a source of error failed: {}",
                     of_view, failure);
}

}  // namespace

std::size_t listed_of_a_cell(const Study& study) {
  return std::max<std::size_t>(20, most_listed / study.file.cells.size());
}

Json report_study(const Study& study, const StudyResults& results) {
  const StudyCell& first = study.file.cells[0];
  const bool localises = first.system.is_localiser();
  Json json{{"file", "study.toml"},
            {"trials", study.file.trials},
            {"seed", first.experiment.seed},
            {"commands", results.commands},
            {"machines", results.machines},
            {"sweep", nullptr},
            {"swept_keys", swept_keys_json(results)},
            {"cells", Json::array()},
            {"same_queries", all_share_queries(results.cells)},
            {"over_worlds", over_worlds_json(results)},
            {"comparisons", comparisons_json(results)}};
  if (localises) {
    json["protocol"] = name(first.experiment.protocol);
    json["method"] = first.experiment.method;
    json["world_ceiling"] =
        results.cells[0].ceiling ? Json(results.cells[0].ceiling->success) : Json(nullptr);
  } else {
    json["system"] = system_json(system_of(study.file));
  }
  for (std::size_t i = 0; i < results.cells.size(); ++i) {
    Json cell = cell_json(results.cells[i]);
    cell["trial_list"] = Json::array();
    for (const TrialResult& t : results.cells[i].trials) {
      if (localises) cell["trial_list"].push_back(trial_json(t));
    }
    json["cells"].push_back(std::move(cell));
  }
  if (study.file.sweep_keys.size() == 1) {
    const std::string& key = study.file.sweep_keys[0];
    Json values = Json::array();
    for (const Json& cell : json["cells"]) values.push_back(cell["settings"].value(key, Json()));
    json["sweep"] = {
        {"key", key}, {"label", key == "sources.calibration" ? "ψ_c" : key}, {"values", values}};
  }
  return json;
}

Json report_world(const World& world) {
  const auto millimetres = [](double x) { return std::round(x * 1000) / 1000; };
  Json json{{"name", world.name}, {"segments", Json::array()}, {"route", Json::array()}};
  for (const WorldSegment& s : world.segments) {
    Json row = Json::array();
    for (const Eigen::Vector3d* end : {&s.a_m, &s.b_m}) {
      for (const double x : *end) row.push_back(millimetres(x));
    }
    json["segments"].push_back(std::move(row));
  }
  for (const RouteLeg& leg : world.route) {
    Json line = Json::array();
    for (const auto& point : leg.points_m) line.push_back({point.x(), point.y()});
    json["route"].push_back(std::move(line));
  }
  json["counts"] = {{"segments", world.segments.size()},
                    {"corners", world.corners.size()},
                    {"surfaces", world.surfaces.size()},
                    {"objects", world.objects.size()},
                    {"repeated_share", repeated_share(world)}};
  return json;
}

Json report_view(const Study& study) {
  const ExperimentSettings& settings = study.file.cells[study.file.cells.size() / 2].experiment;
  const World world = settings.sources.moved > 0
                          ? with_moved_furniture(study.world, settings.sources.moved, settings.seed)
                          : study.world;
  const Visibility visibility(world);
  const Pose2D pose =
      draw_query(visibility, settings.protocol, settings.mount.height_m, settings.seed, 0);
  NoiseFreeViewOptions options =
      look_from(draw_mount(settings.mount, settings.sources, settings.seed, 0));
  options.with_corners = true;
  const NoiseFreeView seen = look(visibility, study.rig.rig, pose, options);
  const Sensor sensor(study.rig.rig, settings.sources);
  StereoObservation sighting = sensor.sense(seen, {.seed = settings.seed});
  const std::string failure = sighting.failure;
  if (!failure.empty()) sighting = {};
  const Json both = sighting_json(study.rig.rig, seen, sighting);
  // A line counts as mismatched if true and sensed disparity differ by more than shifts explain.
  Json sensed = Json::array();
  for (std::size_t i = 0; i < sighting.segments.size(); ++i) {
    SensedEdge exact;
    exact.truth = sighting.true_edges[i];
    const auto middle = [](const ImageSegment& s) { return 0.5 * (s.a_px.x() + s.b_px.x()); };
    const double truth =
        middle(image_of(study.rig.rig, exact, 0)) - middle(image_of(study.rig.rig, exact, 1));
    const double disparity = middle(sighting.segments[i].left) - middle(sighting.segments[i].right);
    Json row = both["sensed"]["left"][i];
    row.push_back(std::abs(disparity - truth) > 2 ? 1 : 0);
    sensed.push_back(std::move(row));
  }
  return {{"camera_size_px", both["camera_size_px"]},
          {"pose", both["pose"]},
          {"true", both["true"]["left"]},
          {"sensed", sensed},
          {"corners", both["corners"]["left"]},
          {"words", view_words(seen.edges.size(), sighting.segments.size(), failure)}};
}

bool has_script(const fs::path& folder) { return fs::is_regular_file(folder / script_file); }

bool has_plots(const fs::path& folder) { return fs::is_regular_file(folder / plotly_file); }

void check_script(const fs::path& folder) {
  if (has_script(folder)) return;
  throw Error("report", "this build has no page script because esbuild was missing",
              "run scripts/install_packages.sh, reconfigure and rebuild");
}

std::string assemble_page(const fs::path& folder, const Json& data) {
  std::string plotly;
  if (has_plots(folder)) {
    plotly = "<script id=\"plotly\">" + read_whole(folder / plotly_file) + "</script>";
  }
  return fill_page(read_whole(folder / "report.html"),
                   {{"<!--VERNIER:CSS-->", read_whole(folder / "report.css")},
                    {"<!--VERNIER:PLOTLY-->", plotly},
                    {"<!--VERNIER:DATA-->", data_script(data)},
                    {"<!--VERNIER:JS-->", read_whole(folder / script_file)}});
}

}  // namespace vernier::cli
