// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/evaluate_draws.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "calib/bootstrap.h"
#include "calib/error.h"
#include "calib/ordered_parallel.h"
#include "calib/resized_rig.h"
#include "calib/rig_file.h"
#include "calib/sampler.h"
#include "cli/share_folder.h"
#include "stereo/canny_edges.h"
#include "stereo/rectification_covariance.h"
#include "stereo/vertical_field.h"
#include "stereo/warped_evaluation.h"

namespace vernier::cli {
namespace {

/// The rig that a scene's calibration errors are drawn of.
struct SceneRig {
  RigEstimate estimate;
  RectifiedGeometry geometry;
  std::string name;
};

SceneRig rig_of(const Scene& scene, Session& session) {
  const Eigen::Vector2i size(scene.pair.left.width_px, scene.pair.left.height_px);
  SceneRig rig;
  if (scene.file.rig.empty()) {
    const RigEstimate nominal = read_rig(find_rig("nominal")).estimate;
    rig.estimate = resized(nominal, size);
    rig.geometry =
        rectified_geometry(rig.estimate.rig, {.f_px = rig.estimate.rig.cameras[0].f_px()});
    rig.name = "nominal, resized";
    return rig;
  }
  RigFile file = read_rig(scene.file.rig);
  for (const std::string& warning : file.warnings) session.warn(warning);
  rig.estimate = std::move(file.estimate);
  required_covariance(rig.estimate, scene.file.rig.string());
  rig.geometry = rectified_geometry(rig.estimate.rig);
  rig.name = scene.file.rig.filename().string();
  if (rig.geometry.size_px != size) {
    throw Error(scene.file.rig.string(),
                fmt::format("it rectifies to {}x{} px, and the pair \"{}\" is {}x{}",
                            rig.geometry.size_px[0], rig.geometry.size_px[1], scene.file.name,
                            size[0], size[1]),
                "give the rig that the pair was rectified by");
  }
  return rig;
}

/// The range with room for what a calibration error of psi_c does to disparities: three standard
/// deviations, over the image.
DisparityRange widened(const DisparityRange& range, const SceneRig& rig, double psi_c) {
  const RectificationUncertainty uncertainty(rig.estimate.rig, rig.estimate.covariance->matrix,
                                             rig.geometry);
  double most = 0;
  for (const double x : {0.1, 0.5, 0.9}) {
    for (const double y : {0.1, 0.5, 0.9}) {
      const Eigen::Vector2d at =
          rig.geometry.size_px.cast<double>().cwiseProduct(Eigen::Vector2d(x, y));
      const auto c = uncertainty.covariance_px2(at, 0.5 * (range.least_px + range.most_px));
      if (c) most = std::max(most, (*c)(0, 0));
    }
  }
  const int room = static_cast<int>(std::ceil(3 * psi_c * std::sqrt(most)));
  return {range.least_px - room, std::min(range.most_px + room, rig.geometry.size_px[0] - 1)};
}

/// What one draw gives, without and with repair.
struct Trial {
  std::vector<DrawFigures> figures[2];
  GeometricError geometry[2];
  bool repaired = false;
};

std::vector<DrawFigures> figures_of(const WarpedPair& warped,
                                    const std::vector<EdgePoint>& edges,
                                    const DisparityRange& range,
                                    const std::vector<Matcher>& matchers,
                                    const EvaluationOptions& how) {
  std::vector<DrawFigures> figures;
  for (const Matcher& matcher : matchers) {
    const WarpedScore s = evaluate(warped, edges, matcher.match(warped.pair, edges, range), how);
    figures.push_back(
        {s.score.all.density, s.score.all.bad_1, s.score.mismatch, s.disparity_error_rms_px});
  }
  return figures;
}

Trial run_trial(WarpedPair warped,
                const DisparityRange& range,
                const std::vector<Matcher>& matchers,
                const EvaluationOptions& how) {
  Trial trial;
  const std::vector<EdgePoint> edges = canny_edges(warped.pair.left);
  trial.figures[0] = figures_of(warped, edges, range, matchers, how);
  trial.geometry[0] = geometric_error(warped, edges, how);
  const VerticalField field = vertical_field(warped.pair, range);
  trial.repaired = field.significant && !field.unrectified;
  if (trial.repaired) {
    repair(warped, field);
    trial.figures[1] = figures_of(warped, edges, range, matchers, how);
    trial.geometry[1] = geometric_error(warped, edges, how);
  } else {
    trial.figures[1] = trial.figures[0];
    trial.geometry[1] = trial.geometry[0];
  }
  return trial;
}

/// Mean of one figure over a cell, with the interval of resampled scenes; of resampled draws where
/// there is one scene.
struct Summary {
  double mean = 0;
  BootstrapInterval interval;
};

Summary summary(const ErrorCell& cell, std::size_t matcher, double DrawFigures::*figure) {
  std::vector<double> values;  // of clusters
  const bool one = cell.figures.size() == 1;
  for (const auto& scene : cell.figures) {
    double sum = 0;
    for (const auto& draw : scene) {
      sum += draw[matcher].*figure;
      if (one) values.push_back(draw[matcher].*figure);
    }
    if (!one) values.push_back(sum / static_cast<double>(scene.size()));
  }
  const auto mean_of = [&](std::span<const std::size_t> drawn) {
    double sum = 0;
    for (const std::size_t k : drawn) sum += values[k];
    return sum / static_cast<double>(drawn.size());
  };
  std::vector<std::size_t> each(values.size());
  std::iota(each.begin(), each.end(), 0);
  return {mean_of(each), bootstrap_interval(values.size(), mean_of, {.resamples = 2000})};
}

double rms(const std::vector<double>& values) {
  double squares = 0;
  for (const double v : values) squares += v * v;
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, values.size())));
}

Json interval_json(const BootstrapInterval& interval) {
  if (!std::isfinite(interval.low)) return Json();
  return {interval.low, interval.high};
}

std::string error_name(const ErrorCell& cell) {
  return cell.rows_px != 0 ? fmt::format("rows {:g} px", cell.rows_px)
                           : fmt::format("psi_c {:g}", cell.psi_c);
}

}  // namespace

EvaluationUnderError::EvaluationUnderError(const std::vector<Matcher>& matchers,
                                           const EvaluationOptions& how,
                                           const DrawOptions& options)
    : matchers_(matchers), how_(how), options_(options) {
  if (options.psi_c.empty() && options.rows_px.empty()) return;
  const auto add = [&](double psi_c, double rows_px) {
    for (const bool repair : {false, true}) cells_.push_back({psi_c, rows_px, repair, {}, {}, {}});
  };
  add(0, 0);
  for (const double psi_c : options.psi_c) {
    if (psi_c > 0) add(psi_c, 0);
  }
  for (const double rows_px : options.rows_px) {
    if (rows_px != 0) add(0, rows_px);
  }
}

void EvaluationUnderError::add(const Scene& scene, Session& session) {
  if (!wanted()) return;
  const SceneRig rig = rig_of(scene, session);
  const RigSampler sampler(rig.estimate, rig.name);
  const auto scenes = static_cast<std::uint32_t>(rigs_.size());
  rigs_.push_back(rig.name);
  for (std::size_t c = 0; c < cells_.size(); c += 2) {
    const double psi_c = cells_[c].psi_c, rows_px = cells_[c].rows_px;
    const auto draws = static_cast<std::size_t>(psi_c > 0 ? options_.draws : 1);
    const DisparityRange range = widened(scene.file.range, rig, psi_c);
    std::vector<Trial> trials(draws);
    for_each_index(draws, options_.threads, [&](std::size_t i) {
      const auto number =
          scenes * static_cast<std::uint32_t>(options_.draws) + static_cast<std::uint32_t>(i);
      trials[i] =
          run_trial(psi_c > 0 ? rectified_by(sampler.sample(psi_c, options_.seed, number),
                                             rig.estimate.rig, rig.geometry, scene.pair, scene.map)
                              : with_rows_moved(scene.pair, scene.map, rows_px),
                    range, matchers_, how_);
    });
    for (const int repaired : {0, 1}) {
      ErrorCell& cell = cells_[c + static_cast<std::size_t>(repaired)];
      cell.figures.emplace_back();
      for (const Trial& trial : trials) {
        cell.figures.back().push_back(trial.figures[repaired]);
        cell.bias_rms_px.push_back(trial.geometry[repaired].bias_rms_px);
        cell.rows_rms_px.push_back(trial.geometry[repaired].rows_rms_px);
        cell.repaired += repaired && trial.repaired;
        ++cell.pairs;
      }
    }
  }
}

Json EvaluationUnderError::json() const {
  Json cells = Json::array();
  for (const ErrorCell& cell : cells_) {
    Json matchers = Json::object();
    for (std::size_t m = 0; m < matchers_.size(); ++m) {
      const Summary density = summary(cell, m, &DrawFigures::density);
      const Summary mismatch = summary(cell, m, &DrawFigures::mismatch);
      matchers[matchers_[m].name] = {
          {"density", density.mean},
          {"density_interval_95", interval_json(density.interval)},
          {"bad_1", summary(cell, m, &DrawFigures::bad_1).mean},
          {"mismatch", mismatch.mean},
          {"mismatch_interval_95", interval_json(mismatch.interval)},
          {"disparity_error_rms_px", summary(cell, m, &DrawFigures::disparity_error_rms_px).mean}};
    }
    cells.push_back({{"psi_c", cell.psi_c},
                     {"rows_moved_px", cell.rows_px},
                     {"repair", cell.repair},
                     {"pairs", cell.pairs},
                     {"repaired", cell.repaired},
                     {"geometric_bias_rms_px", rms(cell.bias_rms_px)},
                     {"rows_rms_px", rms(cell.rows_rms_px)},
                     {"matchers", matchers}});
  }
  return {{"draws", options_.draws}, {"seed", options_.seed}, {"rigs", rigs_}, {"cells", cells}};
}

std::string EvaluationUnderError::text() const {
  if (!wanted()) return "";
  std::string text = fmt::format(
      "\nunder calibration error ({} rigs a pair, drawn of: {}); against the warped truth, 95 % "
      "over {}\n{:<12} {:<7} {:>8} {:>8} {:<10} {:>8} {:>8} {:>8} {:>18} {:>9}\n",
      options_.draws, rigs_.empty() ? "" : rigs_.front(), rigs_.size() > 1 ? "scenes" : "draws",
      "error", "repair", "bias px", "rows px", "matcher", "density", "bad 1", "mismatch", "95 %",
      "error px");
  for (const ErrorCell& cell : cells_) {
    const std::string repair = cell.repair ? fmt::format("{}/{}", cell.repaired, cell.pairs) : "no";
    for (std::size_t m = 0; m < matchers_.size(); ++m) {
      const Summary mismatch = summary(cell, m, &DrawFigures::mismatch);
      const std::string interval =
          std::isfinite(mismatch.interval.low)
              ? fmt::format("{:.2f} … {:.2f} %", 100 * mismatch.interval.low,
                            100 * mismatch.interval.high)
              : "-";
      text += fmt::format(
          "{:<12} {:<7} {:>8.3f} {:>8.3f} {:<10} {:>8.4f} {:>6.2f} % {:>6.2f} % {:>18} {:>9.3f}\n",
          error_name(cell), repair, rms(cell.bias_rms_px), rms(cell.rows_rms_px), matchers_[m].name,
          summary(cell, m, &DrawFigures::density).mean,
          100 * summary(cell, m, &DrawFigures::bad_1).mean, 100 * mismatch.mean, interval,
          summary(cell, m, &DrawFigures::disparity_error_rms_px).mean);
    }
  }
  return text;
}

}  // namespace vernier::cli
