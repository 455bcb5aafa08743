// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/report_data.h"

#include <cmath>
#include <numbers>

#include "calib/atomic_file.h"
#include "calib/depth_uncertainty.h"
#include "calib/error.h"
#include "calib/view_linearisation.h"
#include "cli/rig_table.h"
#include "cli/sighting_json.h"
#include "localise/bhattacharyya.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

Json trial_json(const TrialResult& t) {
  Json row{t.trial, t.truth.x_m, t.truth.y_m, t.truth.heading_rad};
  if (t.answered()) {
    row.insert(row.end(), {t.answer.x_m, t.answer.y_m, t.answer.heading_rad, t.error_m});
  } else {
    row.insert(row.end(), {nullptr, nullptr, nullptr, nullptr});
  }
  row.push_back(t.success() ? 1 : 0);
  return row;
}

/// Residuals of every corner, a list a camera.
Json residuals_json(const RigEstimate& estimate) {
  const CalibrationEvidence& evidence = *estimate.evidence;
  Json cameras = Json::array();
  for (const Camera& camera : estimate.rig.cameras) {
    cameras.push_back({{"camera", camera.name}, {"points", Json::array()}});
  }
  std::size_t frame = 0;
  ViewLinearisation J;
  for (const BoardView& view : evidence.observations.views) {
    while (evidence.frames[frame] != view.frame) ++frame;
    linearise_view(estimate.rig.cameras[view.camera], estimate.rig.T_camera_first[view.camera],
                   evidence.T_first_board[frame], evidence.observations.target_m, view,
                   Linearise::residual_only, J);
    for (std::size_t i = 0; i < view.pixels_px.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(2 * i);
      cameras[view.camera]["points"].push_back(
          {view.pixels_px[i].x(), view.pixels_px[i].y(), J.residual_px[k], J.residual_px[k + 1]});
    }
  }
  return cameras;
}

Json depth_json(const RigEstimate& estimate) {
  Json rows = Json::array();
  for (const DepthUncertainty& u : depth_uncertainty(estimate, {0.5, 1, 2, 3, 5, 7, 10, 15, 20})) {
    rows.push_back({{"range_m", u.range_m},
                    {"sigma_linear_m", u.sigma_linear_m},
                    {"sigma_sampled_m", u.sigma_sampled_m},
                    {"non_physical_share", u.non_physical_share}});
  }
  return rows;
}

/// Fills the template's marks in one pass, so that what is put in is never searched again.
std::string fill(const std::string& page,
                 const std::vector<std::pair<std::string, std::string>>& parts) {
  std::string filled;
  std::size_t at = 0;
  while (at < page.size()) {
    std::size_t next = page.size();
    const std::pair<std::string, std::string>* which = nullptr;
    for (const auto& part : parts) {
      const std::size_t found = page.find(part.first, at);
      if (found < next) {
        next = found;
        which = &part;
      }
    }
    filled.append(page, at, next - at);
    if (which) filled += which->second;
    at = which ? next + which->first.size() : page.size();
  }
  return filled;
}

/// Scripts of the page in the order of their names.
std::string scripts_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".js") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::string text;
  for (const fs::path& file : files) text += read_whole(file) + "\n";
  return text;
}

}  // namespace

Json report_study(const Study& study, const StudyResults& results) {
  const StudyCell& first = study.file.cells[0];
  Json json{
      {"file", "study.toml"},
      {"trials", study.file.trials},
      {"seed", first.experiment.seed},
      {"protocol", name(first.experiment.protocol)},
      {"method", first.experiment.method},
      {"world_ceiling",
       std::isfinite(results.cells[0].ceiling) ? Json(results.cells[0].ceiling) : Json(nullptr)},
      {"sweep", nullptr},
      {"cells", Json::array()},
      {"comparisons", Json::array()}};
  if (study.file.sweep_keys.size() == 1) {
    const std::string& key = study.file.sweep_keys[0];
    Json values = Json::array();
    for (const CellResult& cell : results.cells) values.push_back(cell_json(cell)["settings"][key]);
    json["sweep"] = {
        {"key", key}, {"label", key == "sources.calibration" ? "ψ_c" : key}, {"values", values}};
  }
  for (std::size_t i = 0; i < results.cells.size(); ++i) {
    Json cell = cell_json(results.cells[i]);
    cell["trial_list"] = Json::array();
    for (const TrialResult& t : results.cells[i].trials) {
      cell["trial_list"].push_back(trial_json(t));
    }
    json["cells"].push_back(std::move(cell));
    if (i == 0) continue;
    const PairedComparison c = compare(results.cells[i - 1], results.cells[i]);
    json["comparisons"].push_back({{"a", short_label(results.cells[i - 1].cell)},
                                   {"b", short_label(results.cells[i].cell)},
                                   {"both", c.both},
                                   {"only_a", c.only_a},
                                   {"only_b", c.only_b},
                                   {"neither", c.neither},
                                   {"mcnemar_p", c.mcnemar_p}});
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

Json report_rig(const RigEstimate& estimate, const std::string& file) {
  const auto list = [](const Eigen::VectorXd& v) {
    return std::vector<double>(v.begin(), v.end());
  };
  const Json table = rig_json(estimate);
  Json json{{"file", file}, {"cameras", Json::array()}};
  for (const Camera& camera : estimate.rig.cameras) {
    json["cameras"].push_back({{"name", camera.name},
                               {"model", model_name(camera.model)},
                               {"size_px", {camera.size_px[0], camera.size_px[1]}}});
  }
  json["names"] = parameter_names(estimate.rig);
  json["values"] = list(parameters(estimate.rig));
  json["sigma_mvb"] = table.value("sigma_mvb", Json(nullptr));
  json["calibration"] = nullptr;
  if (estimate.calibration) {
    const CalibrationSummary& s = *estimate.calibration;
    json["calibration"] = {{"rms_px", s.rms_px}, {"pixel_sigma_px", s.pixel_sigma_px},
                           {"chi2", s.chi2},     {"dof", s.dof},
                           {"views", s.views},   {"warnings", s.warnings}};
  }
  if (estimate.covariance) {
    const ScaledDecomposition decomposition(*estimate.covariance);
    json["sigma"] = table["sigma"];
    json["kind"] = name(estimate.covariance->kind);
    json["raw_condition"] = decomposition.raw_condition();
    json["scaled_condition"] = decomposition.scaled_condition();
    json["directions"] = table["directions"];
    const Eigen::VectorXd sd = estimate.covariance->matrix.diagonal().cwiseSqrt();
    json["correlation"] = Json::array();
    for (Eigen::Index i = 0; i < sd.size(); ++i) {
      std::vector<double> row;
      for (Eigen::Index j = 0; j < sd.size(); ++j) {
        const double scale = sd[i] * sd[j];
        row.push_back(scale > 0 ? estimate.covariance->matrix(i, j) / scale : 0);
      }
      json["correlation"].push_back(row);
    }
    if (estimate.rig.cameras.size() == 2) json["depth"] = depth_json(estimate);
  }
  if (estimate.evidence) json["residuals"] = residuals_json(estimate);
  return json;
}

Json report_view(const Study& study) {
  const ExperimentSettings& settings = study.file.cells[study.file.cells.size() / 2].experiment;
  const Visibility visibility(study.world);
  const PlanePose pose =
      draw_query(visibility, settings.protocol, settings.mount.height_m, settings.seed, 0);
  LookOptions options;
  options.mount = settings.mount;
  options.with_corners = true;
  const Look seen = look(visibility, study.rig.rig, pose, options);
  const Sensor sensor(study.rig.rig, settings.sources);
  const StereoSighting sighting = sensor.sense(seen, settings.seed, 0, 0);
  const Json both = sighting_json(study.rig.rig, seen, sighting);
  // A line counts as mismatched where its true and sensed disparity differ by more than shifts do.
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
  return {
      {"camera_size_px", both["camera_size_px"]},
      {"pose", both["pose"]},
      {"true", both["true"]["left"]},
      {"sensed", sensed},
      {"corners", both["corners"]["left"]},
      {"words", fmt::format("The left view of trial 0: {} edges in view of both eyes, {} sensed "
                            "after all sources have acted.",
                            seen.edges.size(), sighting.segments.size())}};
}

std::string assemble_page(const fs::path& folder, const Json& data) {
  std::string json;
  for (const char c : data.dump()) {  // no "<" may end or open anything in the page
    if (c == '<') {
      json += "\\u003c";
    } else {
      json += c;
    }
  }
  std::string plotly;
  for (const fs::path& file :
       {folder / "plotly-cartesian.min.js",
        folder / "node_modules" / "plotly.js-cartesian-dist-min" / "plotly-cartesian.min.js"}) {
    if (plotly.empty() && fs::is_regular_file(file)) {
      plotly = "<script>" + read_whole(file) + "</script>";
    }
  }
  return fill(read_whole(folder / "report.html"),
              {{"<!--VERNIER:CSS-->", read_whole(folder / "report.css")},
               {"<!--VERNIER:PLOTLY-->", plotly},
               {"<!--VERNIER:DATA-->",
                "<script type=\"application/json\" id=\"data\">" + json + "</script>"},
               {"<!--VERNIER:JS-->", scripts_in(folder / "js")}});
}

}  // namespace vernier::cli
