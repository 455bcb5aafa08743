// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/model_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calib/board_pose.h"
#include "calib/board_warp.h"
#include "calib/error.h"
#include "calib/model_nesting.h"

namespace vernier {
namespace {

constexpr int fewest_frames = 6;
constexpr int most_groups = 8;
constexpr double clear_gain_sigmas = 3;  // a false warning once in 700 models, were gains normal
constexpr double clear_move_sigmas = 3;

/// The frames that are compared: all, or evenly spaced ones.
std::vector<int> compared_frames(const std::vector<int>& frames, int most) {
  const auto n = static_cast<int>(frames.size());
  if (n <= most) return frames;
  std::vector<int> some;
  for (int k = 0; k < most; ++k) some.push_back(frames[static_cast<std::size_t>(k) * n / most]);
  return some;
}

BoardObservations at(const BoardObservations& observations, const std::vector<int>& frames) {
  BoardObservations part = observations;
  std::erase_if(part.views, [&](const BoardView& view) {
    return !std::binary_search(frames.begin(), frames.end(), view.frame);
  });
  return part;
}

/// The problem of the options with the noise that was found.
ReprojectionProblem problem_for(const CalibrationOptions& options,
                                const Rig& rig,
                                double pixel_sigma_px) {
  ReprojectionProblem problem = problem_of(options, rig);
  problem.pixel_sigma_px = pixel_sigma_px;
  return problem;
}

/// Squared error of every frame when its group was left out, and the coordinates it holds.
struct HeldOut {
  std::vector<double> squared_px2;
  std::vector<int> coordinates;
};

HeldOut held_out_errors(const BoardObservations& observations,
                        const BoardState& state,
                        const ReprojectionProblem& problem) {
  const auto frames = static_cast<int>(state.frames.size());
  const int groups = std::min(frames, most_groups);
  HeldOut errors{std::vector<double>(frames), std::vector<int>(frames)};
  for (int group = 0; group < groups; ++group) {
    std::vector<int> kept;
    for (int f = 0; f < frames; ++f) {
      if (f % groups != group) kept.push_back(state.frames[f]);
    }
    const BoardState trained =
        minimise_reprojection(at(observations, kept), at_frames(state, kept), problem);
    const auto target_m = warped_target(observations.target_m, trained.warp_m);
    for (int f = group; f < frames; f += groups) {
      const std::vector<BoardView> views = at(observations, {state.frames[f]}).views;
      const BoardPoseFit fit =
          fit_board_pose(target_m, views, trained.rig, state.T_first_board[f], 50);
      for (const BoardView& view : views) {
        errors.coordinates[f] += 2 * static_cast<int>(view.ids.size());
      }
      errors.squared_px2[f] = fit.rms_px * fit.rms_px * errors.coordinates[f];
    }
  }
  return errors;
}

double rms(const HeldOut& errors) {
  double sum = 0;
  int n = 0;
  for (std::size_t f = 0; f < errors.squared_px2.size(); ++f) {
    sum += errors.squared_px2[f];
    n += errors.coordinates[f];
  }
  return std::sqrt(sum / n);
}

void compare_errors(const HeldOut& in_use, const HeldOut& richer, ModelScore& score) {
  const auto n = static_cast<double>(in_use.squared_px2.size());
  double sum = 0, squares = 0;
  for (std::size_t f = 0; f < in_use.squared_px2.size(); ++f) {
    const double gain = in_use.squared_px2[f] - richer.squared_px2[f];
    score.better_views += gain > 0;
    sum += gain;
    squares += gain * gain;
  }
  const double mean = sum / n;
  const double scatter = std::sqrt((squares / n - mean * mean) / (n - 1));
  score.gain_sigmas = scatter > 0 ? mean / scatter : 0;
}

void compare_parameters(const RigEstimate& estimate, const Rig& richer, ModelScore& score) {
  const std::vector<std::string> names = parameter_names(estimate.rig),
                                 others = parameter_names(richer);
  const Eigen::VectorXd a = parameters(estimate.rig), b = parameters(richer);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto k = std::find(others.begin(), others.end(), names[i]) - others.begin();
    const auto row = static_cast<Eigen::Index>(i);
    const bool distorts =
        names[i].find(".k") != std::string::npos || names[i].find(".p") != std::string::npos;
    const double sigma = std::sqrt(estimate.covariance->matrix(row, row));
    if (distorts || k == static_cast<std::ptrdiff_t>(others.size()) || !(sigma > 0)) continue;
    const double move = std::abs(b[k] - a[row]) / sigma;
    if (move <= score.largest_move_sigmas) continue;
    score.largest_move_sigmas = move;
    score.largest_move = names[i];
  }
}

std::string name_of(const std::vector<CameraModel>& models) {
  std::string name;
  bool same = true;
  for (const CameraModel& model : models) {
    same = same && model.index() == models.front().index();
    name += (name.empty() ? "" : ",") + std::string(model_name(model));
  }
  return same ? std::string(model_name(models.front())) : name;
}

/// The richer models of a rig: every camera one step up, then two, as far as there are any. More
/// would cost time for models that few sets of views determine.
std::vector<std::vector<CameraModel>> candidates(const Rig& rig) {
  std::vector<std::vector<CameraModel>> all;
  for (std::size_t step = 0; step < 2; ++step) {
    std::vector<CameraModel> models = models_of(rig);
    bool moved = false;
    for (CameraModel& model : models) {
      const std::vector<CameraModel> richer = richer_models(model);
      if (richer.empty()) continue;
      moved = moved || step < richer.size();
      model = richer[std::min(step, richer.size() - 1)];
    }
    if (!moved) break;
    all.push_back(std::move(models));
  }
  return all;
}

std::vector<std::string> warnings_of(const ModelComparison& comparison) {
  const ModelScore* best = nullptr;
  for (const ModelScore& score : comparison.richer) {
    const bool clear = score.gain_sigmas > clear_gain_sigmas &&
                       score.held_out_rms_px < 0.98 * comparison.in_use.held_out_rms_px;
    // A richer one still must be clearly better than the one found.
    if (clear && (!best || score.held_out_rms_px < 0.98 * best->held_out_rms_px)) best = &score;
  }
  if (!best) return {};
  std::string text = fmt::format(
      "residuals are structured: {} predicts views left out at {:.3f} px where {} has {:.3f} px "
      "({} of {} views better)",
      best->name, best->held_out_rms_px, comparison.in_use.name, comparison.in_use.held_out_rms_px,
      best->better_views, comparison.frames);
  if (best->largest_move_sigmas > clear_move_sigmas) {
    text += fmt::format(
        "; it moves {} by {:.1f} of its stated standard deviations, which no "
        "covariance covers",
        best->largest_move, best->largest_move_sigmas);
  }
  return {text + "; use --model " + best->name};
}

}  // namespace

ModelComparison compare_models(const RigEstimate& estimate,
                               const CalibrationOptions& options,
                               int most_frames) {
  ModelComparison comparison;
  if (!estimate.evidence || !estimate.covariance || !estimate.calibration) {
    throw Error("model comparison", "the calibration has no evidence or covariance",
                "calibrate from corners");
  }
  const CalibrationEvidence& evidence = *estimate.evidence;
  const auto models = candidates(estimate.rig);
  if (models.empty() || evidence.frames.size() < fewest_frames) return comparison;

  const double sigma = estimate.calibration->pixel_sigma_px;
  const std::vector<int> frames = compared_frames(evidence.frames, most_frames);
  const BoardState whole{estimate.rig, evidence.frames, evidence.T_first_board, evidence.warp_m};
  const BoardState state = at_frames(whole, frames);
  const BoardObservations observations = at(evidence.observations, frames);
  const HeldOut in_use =
      held_out_errors(observations, state, problem_for(options, estimate.rig, sigma));
  comparison.frames = static_cast<int>(frames.size());
  comparison.in_use.models = models_of(estimate.rig);
  comparison.in_use.name = name_of(comparison.in_use.models);
  comparison.in_use.held_out_rms_px = rms(in_use);
  comparison.in_use.fitted_rms_px = estimate.calibration->rms_px;
  for (const std::vector<CameraModel>& richer : models) {
    try {
      BoardState start = state;
      start.rig = in_models(state.rig, richer);
      const ReprojectionProblem problem = problem_for(options, start.rig, sigma);
      const BoardState fitted = minimise_reprojection(observations, start, problem);
      const ReducedNormalEquations equations =
          reduced_normal_equations(observations, fitted, sigma, options.warp);
      minimum_variance_bound(equations, parameter_names(fitted.rig));  // is it determined?
      const HeldOut errors = held_out_errors(observations, fitted, problem);
      ModelScore score;
      score.models = richer;
      score.name = name_of(richer);
      score.held_out_rms_px = rms(errors);
      score.fitted_rms_px = sigma * std::sqrt(equations.chi2 / equations.residuals);
      compare_errors(in_use, errors, score);
      compare_parameters(estimate, fitted.rig, score);
      comparison.richer.push_back(std::move(score));
    } catch (const Error&) {
      break;  // the views do not determine this model, nor a richer one
    }
  }
  comparison.warnings = warnings_of(comparison);
  return comparison;
}

}  // namespace vernier
