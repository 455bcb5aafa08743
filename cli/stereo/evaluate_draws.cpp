// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/evaluate_draws.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "calib/base/ordered_parallel.h"
#include "calib/error.h"
#include "calib/estimate/resized_rig.h"
#include "calib/interval.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "calib/sampler.h"
#include "calib/statistics/cluster_interval.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "cli/stereo/evaluate_scene.h"
#include "stereo/canny_edges.h"
#include "stereo/evaluation/warped_evaluation.h"
#include "stereo/evaluation/warped_pair.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/rectification.h"
#include "stereo/rectification/rectification_covariance.h"
#include "stereo/rectification/vertical_field.h"
#include "stereo/stereo_truth.h"

namespace vernier::cli {
/// The result of one sample, without and with repair.
struct DrawTrial {
  std::vector<DrawMetrics> figures[2];
  GeometricError geometry[2];
  bool repaired = false, physical = true;
};

namespace {

/// The rig whose covariance a scene's calibration errors are sampled from.
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
  RigFile file = read_rig(find_rig(scene.file.rig.string()));
  for (const std::string& warning : file.warnings) session.warn(warning);
  rig.estimate = std::move(file.estimate);
  required_covariance(rig.estimate, scene.file.rig.string());
  rig.geometry = rectified_geometry(rig.estimate.rig);
  rig.name = scene.file.rig.filename().string();
  if (rig.geometry.size_px != size) {
    throw Error(scene.file.rig.string(),
                fmt::format("the rectified size is {}x{} px, but the pair \"{}\" is {}x{}",
                            rig.geometry.size_px[0], rig.geometry.size_px[1], scene.file.name,
                            size[0], size[1]),
                "give the rig that the pair was rectified with");
  }
  return rig;
}

/// The range extended by the effect of a calibration error of psi_c on disparities: three standard
/// deviations, maximum over the image.
DisparityRange widened(const DisparityRange& range, const SceneRig& rig, double psi_c) {
  const RectificationUncertainty uncertainty(rig.estimate.rig, rig.estimate.covariance->matrix,
                                             rig.geometry);
  double most = 0;
  for (const double x : {0.1, 0.5, 0.9}) {
    for (const double y : {0.1, 0.5, 0.9}) {
      const Eigen::Vector2d at =
          rig.geometry.size_px.cast<double>().cwiseProduct(Eigen::Vector2d(x, y));
      const auto c = uncertainty.covariance_px2(at, 0.5 * (range.min_px + range.max_px));
      if (c) most = std::max(most, (*c)(0, 0));
    }
  }
  const int last = rig.geometry.size_px[0] - 1;
  const int room = static_cast<int>(std::min<double>(last, std::ceil(3 * psi_c * std::sqrt(most))));
  return {std::max(range.min_px - room, -last), std::min(range.max_px + room, last)};
}

/// Position of the right camera in the left camera frame.
Eigen::Vector3d right_centre_m(const Rig& rig) {
  const Pose& pose = rig.T_camera_first[1];
  return -pose.R.transpose() * pose.t;
}

/// Whether the cameras are still side by side in the same order.
bool is_physical(const Rig& drawn, const Rig& true_rig) {
  const Eigen::Vector3d baseline = right_centre_m(true_rig);
  const bool finite = parameters(drawn).allFinite();
  return finite && right_centre_m(drawn).dot(baseline) > 0.1 * baseline.squaredNorm() &&
         drawn.cameras[0].f_px() > 0 && drawn.cameras[1].f_px() > 0;
}

std::vector<DrawMetrics> figures_of(const WarpedPair& warped,
                                    const std::vector<EdgePoint>& edges,
                                    const std::vector<TruthAtEdge>& truth,
                                    const DisparityRange& range,
                                    const std::vector<Matcher>& matchers,
                                    const EvaluationOptions& how) {
  std::vector<DrawMetrics> figures;
  for (const Matcher& matcher : matchers) {
    const WarpedScore s =
        evaluate(warped, edges, truth, matcher.match(warped.pair, edges, range), how);
    const auto of = [](int count, double figure) { return count > 0 ? figure : NAN; };
    const int matched = s.score.all.matched;
    figures.push_back({of(s.score.all.edges, s.score.all.density), of(matched, s.score.all.bad_1),
                       of(matched + s.score.occluded_matched, s.score.mismatch),
                       of(s.right, s.disparity_error_rms_px)});
  }
  return figures;
}

DrawTrial run_trial(WarpedPair warped,
                    const DisparityRange& range,
                    const std::vector<Matcher>& matchers,
                    const EvaluationOptions& how) {
  DrawTrial trial;
  const std::vector<EdgePoint> edges = canny_edges(warped.pair.left);
  const auto score = [&](std::size_t repaired) {
    const std::vector<TruthAtEdge> truth = truth_at(warped, edges);
    trial.figures[repaired] = figures_of(warped, edges, truth, range, matchers, how);
    trial.geometry[repaired] = geometric_error(warped, edges, truth, how);
  };
  score(0);
  const VerticalField field = vertical_field(warped.pair, range);
  trial.repaired = field.significant && !field.unrectified;
  if (trial.repaired) {
    repair(warped, field);
    score(1);
  } else {
    trial.figures[1] = trial.figures[0];
    trial.geometry[1] = trial.geometry[0];
  }
  return trial;
}

/// The pair with its own vertical misalignment corrected, so that only sampled errors remain.
RectifiedPair without_own_field(const Scene& scene) {
  const VerticalField own = vertical_field(scene.pair, scene.file.range);
  RectifiedPair pair = scene.pair;
  if (!own.unrectified) correct_right(own, pair);
  return pair;
}

/// NaN for an empty list.
double mean_of_numbers(const std::vector<double>& values) {
  double sum = 0;
  int count = 0;
  for (const double v : values) {
    if (std::isnan(v)) continue;
    sum += v;
    ++count;
  }
  return count > 0 ? sum / count : NAN;
}

/// A metric per scene, or per sample if there is only one scene; missing values are skipped.
std::vector<double> clusters_of(const ErrorCell& cell,
                                std::size_t matcher,
                                double DrawMetrics::*figure) {
  std::vector<double> clusters;
  for (const auto& scene : cell.figures) {
    std::vector<double> draws;
    draws.reserve(scene.size());
    for (const auto& draw : scene) draws.push_back(draw[matcher].*figure);
    if (cell.figures.size() == 1) {
      clusters = draws;
    } else {
      clusters.push_back(mean_of_numbers(draws));
    }
  }
  std::erase_if(clusters, [](double value) { return std::isnan(value); });
  return clusters;
}

double mean_of(const ErrorCell& cell, std::size_t matcher, double DrawMetrics::*figure) {
  return mean_of_numbers(clusters_of(cell, matcher, figure));
}

Interval interval_of(const ErrorCell& cell, std::size_t matcher, double DrawMetrics::*figure) {
  const std::vector<double> clusters = clusters_of(cell, matcher, figure);
  const Interval interval = cluster_interval(static_cast<int>(clusters.size()),
                                             [&](std::span<const std::size_t> drawn) {
                                               double sum = 0;
                                               for (const std::size_t k : drawn) sum += clusters[k];
                                               return sum / static_cast<double>(drawn.size());
                                             },
                                             {.resamples = 1999});
  return {std::fmax(0, interval.low), interval.high};
}

double rms(const std::vector<double>& values) {
  std::vector<double> squares;
  squares.reserve(values.size());
  for (const double v : values) squares.push_back(v * v);
  return std::sqrt(mean_of_numbers(squares));
}

Json interval_json(const Interval& interval) {
  if (!std::isfinite(interval.high)) return Json();
  return {interval.low, std::min(1.0, interval.high)};
}

std::string error_name(const ErrorCell& cell) {
  return cell.rows_px != 0 ? fmt::format("rows {:g} px", cell.rows_px)
                           : fmt::format("psi_c {:g}", cell.psi_c);
}

std::string percent_or_dash(double share) {
  return std::isnan(share) ? "-" : fmt::format("{:.2f} %", 100 * share);
}

std::string pixels(double px) { return std::isnan(px) ? "-" : fmt::format("{:.3f}", px); }

std::string line_of(const ErrorCell& cell, std::size_t m, const std::string& matcher) {
  const auto mean = [&](double DrawMetrics::*figure) { return mean_of(cell, m, figure); };
  const Json interval = interval_json(interval_of(cell, m, &DrawMetrics::mismatch));
  const std::string range = interval.is_null()
                                ? "-"
                                : fmt::format("{:.2f} … {:.2f} %", 100 * interval[0].get<double>(),
                                              100 * interval[1].get<double>());
  const std::string repair = cell.repair ? fmt::format("{}/{}", cell.repaired, cell.pairs) : "no";
  return fmt::format(
      "{:<12} {:<7} {:>8} {:>8} {:<10} {:>8} {:>8} {:>8} {:>18} {:>9}\n", error_name(cell), repair,
      pixels(rms(cell.bias_rms_px)), pixels(rms(cell.rows_rms_px)), matcher,
      percent_or_dash(mean(&DrawMetrics::density)), percent_or_dash(mean(&DrawMetrics::bad_1)),
      percent_or_dash(mean(&DrawMetrics::mismatch)), range,
      pixels(mean(&DrawMetrics::disparity_error_rms_px)));
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
  const bool draws_wanted =
      std::any_of(cells_.begin(), cells_.end(), [](const auto& cell) { return cell.psi_c > 0; });
  std::optional<SceneRig> rig;
  std::optional<RigSampler> sampler;
  if (draws_wanted) {
    rig = rig_of(scene, session);
    sampler.emplace(rig->estimate, rig->name);
    rigs_.push_back(rig->name);
  }
  const RectifiedPair pair = without_own_field(scene);
  const auto draw = [&](double psi_c, const DisparityRange& range, std::size_t i) {
    const auto number =
        scenes_ * static_cast<std::uint32_t>(options_.draws) + static_cast<std::uint32_t>(i);
    const Rig drawn = sampler->sample(psi_c, options_.seed, number);
    if (!is_physical(drawn, rig->estimate.rig)) {
      DrawTrial none;
      none.physical = false;
      return none;
    }
    return run_trial(rectified_by(drawn, rig->estimate.rig, rig->geometry, pair, scene.map), range,
                     matchers_, how_);
  };
  for (std::size_t c = 0; c < cells_.size(); c += 2) {
    const double psi_c = cells_[c].psi_c;
    std::vector<DrawTrial> trials(static_cast<std::size_t>(psi_c > 0 ? options_.draws : 1));
    if (psi_c > 0) {
      const DisparityRange range = widened(scene.file.range, *rig, psi_c);
      for_each_index(trials.size(), options_.threads,
                     [&](std::size_t i) { trials[i] = draw(psi_c, range, i); });
    } else {
      trials[0] = run_trial(with_shifted_rows(pair, scene.map, cells_[c].rows_px), scene.file.range,
                            matchers_, how_);
    }
    for (const std::size_t repaired : {0u, 1u}) take(trials, repaired, cells_[c + repaired]);
  }
  ++scenes_;
}

void EvaluationUnderError::take(const std::vector<DrawTrial>& trials,
                                std::size_t repaired,
                                ErrorCell& cell) const {
  cell.figures.emplace_back();
  for (const DrawTrial& trial : trials) {
    if (!trial.physical) {
      ++cell.not_physical;
      continue;
    }
    const GeometricError& geometry = trial.geometry[repaired];
    cell.figures.back().push_back(trial.figures[repaired]);
    cell.bias_rms_px.push_back(geometry.edges > 0 ? geometry.bias_rms_px : NAN);
    cell.rows_rms_px.push_back(geometry.edges > 0 ? geometry.rows_rms_px : NAN);
    cell.repaired += repaired != 0 && trial.repaired;
    ++cell.pairs;
  }
}

Json EvaluationUnderError::json() const {
  Json cells = Json::array();
  for (const ErrorCell& cell : cells_) {
    Json matchers = Json::object();
    for (std::size_t m = 0; m < matchers_.size(); ++m) {
      const auto mean = [&](double DrawMetrics::*figure) {
        return json_number(mean_of(cell, m, figure));
      };
      const auto interval = [&](double DrawMetrics::*figure) {
        return interval_json(interval_of(cell, m, figure));
      };
      matchers[matchers_[m].name] = {
          {"density", mean(&DrawMetrics::density)},
          {"density_interval_95", interval(&DrawMetrics::density)},
          {"bad_1", mean(&DrawMetrics::bad_1)},
          {"mismatch", mean(&DrawMetrics::mismatch)},
          {"mismatch_interval_95", interval(&DrawMetrics::mismatch)},
          {"disparity_error_rms_px", mean(&DrawMetrics::disparity_error_rms_px)}};
    }
    cells.push_back({{"psi_c", cell.psi_c},
                     {"rows_moved_px", cell.rows_px},
                     {"repair", cell.repair},
                     {"pairs", cell.pairs},
                     {"repaired", cell.repaired},
                     {"not_physical", cell.not_physical},
                     {"geometric_bias_rms_px", json_number(rms(cell.bias_rms_px))},
                     {"rows_rms_px", json_number(rms(cell.rows_rms_px))},
                     {"matchers", matchers}});
  }
  return {{"draws", options_.draws}, {"seed", options_.seed}, {"rigs", rigs_}, {"cells", cells}};
}

std::string EvaluationUnderError::text() const {
  if (!wanted()) return "";
  const std::set<std::string> rigs(rigs_.begin(), rigs_.end());
  std::string text = "\nunder calibration error, against the warped ground truth";
  if (!rigs.empty()) {
    text +=
        fmt::format(": {} rigs per pair, sampled from {}", options_.draws, fmt::join(rigs, ", "));
  }
  text += fmt::format("\n{:<12} {:<7} {:>8} {:>8} {:<10} {:>8} {:>8} {:>8} {:>18} {:>9}\n", "error",
                      "repair", "bias px", "rows px", "matcher", "density", "bad 1", "mismatch",
                      scenes_ > 1 ? "95 % over scenes" : "95 % over samples", "error px");
  for (const ErrorCell& cell : cells_) {
    for (std::size_t m = 0; m < matchers_.size(); ++m) {
      text += line_of(cell, m, matchers_[m].name);
    }
    if (cell.not_physical > 0 && !cell.repair) {
      text += fmt::format("             {} samples excluded: cameras swapped or no baseline\n",
                          cell.not_physical);
    }
  }
  return text;
}

}  // namespace vernier::cli
