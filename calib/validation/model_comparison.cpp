// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/validation/model_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "calib/board/board_pose.h"
#include "calib/board/board_warp.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/board_target.h"
#include "calib/calibrate.h"
#include "calib/calibration/calibration_problem.h"
#include "calib/calibration/minimum_variance_bound.h"
#include "calib/calibration/outliers.h"
#include "calib/camera.h"
#include "calib/camera/model_nesting.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/solver/linearised_cost.h"
#include "calib/solver/minimise_reprojection.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {
namespace {

constexpr int min_frames_to_compare = 6;
constexpr int max_groups = 8;
constexpr double clear_gain_sigmas = 3;  // a false warning once in 700 models for normal gains
constexpr double clear_move_sigmas = 3;

/// The problem of the options, with the estimated noise.
ReprojectionProblem problem_for(const CalibrationOptions& options,
                                const Rig& rig,
                                double pixel_sigma_px) {
  ReprojectionProblem problem = problem_of(options, rig);
  problem.pixel_sigma_px = pixel_sigma_px;
  return problem;
}

/// Squared error of every held-out frame, and its number of coordinates.
struct HeldOut {
  std::vector<double> squared_px2;
  std::vector<int> coordinates;
};

/// Frames by group: dealt in turn, frames seen by the same cameras consecutively, so that no group
/// contains all frames of a camera.
std::vector<std::vector<int>> dealt(const BoardObservations& observations) {
  std::map<int, std::vector<int>> cameras_of;  // by frame
  for (const BoardView& view : observations.views) cameras_of[view.frame].push_back(view.camera);
  std::map<std::vector<int>, std::vector<int>> seen_by;  // frames by cameras
  for (const auto& [frame, cameras] : cameras_of) seen_by[cameras].push_back(frame);
  std::vector<std::vector<int>> groups(std::min<std::size_t>(cameras_of.size(), max_groups));
  std::size_t next = 0;
  for (const auto& [cameras, frames] : seen_by) {
    for (const int frame : frames) groups[next++ % groups.size()].push_back(frame);
  }
  return groups;
}

/// The minimum from `start`. Throws Error if the views do not determine it.
BoardState determined_minimum(const BoardObservations& observations,
                              const BoardState& start,
                              const ReprojectionProblem& problem) {
  BoardState state = minimise_reprojection(observations, start, problem);
  const LinearisedCost cost = linearised_cost(observations, state, problem);
  minimum_variance_bound(cost.equations, cost.names);
  return state;
}

HeldOut held_out_errors(const BoardObservations& observations,
                        const BoardState& state,
                        const ReprojectionProblem& problem) {
  const std::size_t frames = state.frames.size();
  HeldOut errors{std::vector<double>(frames), std::vector<int>(frames)};
  for (const std::vector<int>& group : dealt(observations)) {
    std::vector<int> kept = state.frames;
    std::erase_if(kept, [&](int frame) {
      return std::find(group.begin(), group.end(), frame) != group.end();
    });
    const BoardState trained =
        determined_minimum(at_frames(observations, kept), at_frames(state, kept), problem);
    const auto target_m = warped_target(observations.target_m, trained.warp_m);
    for (const int frame : group) {
      const auto f = static_cast<std::size_t>(
          std::lower_bound(state.frames.begin(), state.frames.end(), frame) - state.frames.begin());
      const std::vector<BoardView> views = at_frames(observations, {frame}).views;
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

double rms(const CornerResiduals& residuals) {
  double sum = 0, n = 0;
  for (const auto& view : residuals) {
    for (const Eigen::Vector2d& r : view) sum += r.squaredNorm();
    n += 2 * static_cast<double>(view.size());
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
    if (!name.empty()) name += ",";
    name += model_name(model);
  }
  return same ? std::string(model_name(models.front())) : name;
}

/// The richer models of a rig: every camera one step up, then two, as far as possible. Further
/// models would cost time, and few sets of views determine them.
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
    // An even richer model must be clearly better than the one found.
    if (clear && (!best || score.held_out_rms_px < 0.98 * best->held_out_rms_px)) best = &score;
  }
  if (!best) return {};
  std::string text = fmt::format(
      "residuals are structured: {} predicts held-out views to {:.3f} px, {} to {:.3f} px (better "
      "in {} of {} views)",
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

/// The minimum of a richer model from a start of its own: that of the model in use may lie where
/// the richer one folds the image. Throws Error if the views do not determine it.
BoardState fitted_afresh(const BoardObservations& observations,
                         const std::vector<CameraModel>& models,
                         const CalibrationOptions& options,
                         const ReprojectionProblem& problem) {
  CalibrationOptions how = options;
  how.models = models;
  how.reject_outliers = how.check_input = false;
  how.board_shape = how.motion = how.baseline_motion = how.board_aspect = false;
  const RigEstimate estimate = calibrate(observations, how);
  const CalibrationEvidence& evidence = *estimate.evidence;
  if (evidence.frames != frames_of(observations)) {
    throw Error("model comparison", "frames lie beyond its field", "");
  }
  return determined_minimum(
      observations, {estimate.rig, evidence.frames, evidence.T_first_board, evidence.warp_m},
      problem);
}

/// A richer model fitted to all views and to those left by each group. Throws Error if they do not
/// determine it.
ModelScore score_of(const std::vector<CameraModel>& richer,
                    const RigEstimate& estimate,
                    const CalibrationOptions& options,
                    const BoardObservations& observations,
                    const BoardState& state,
                    const HeldOut& in_use) {
  BoardState start = state;
  start.rig = in_models(state.rig, richer);
  const ReprojectionProblem problem =
      problem_for(options, start.rig, estimate.calibration->pixel_sigma_px);
  BoardState fitted;
  HeldOut errors;
  try {
    fitted = determined_minimum(observations, start, problem);
    errors = held_out_errors(observations, fitted, problem);
  } catch (const Error&) {
    fitted = fitted_afresh(observations, richer, options, problem);
    errors = held_out_errors(observations, fitted, problem);
  }
  ModelScore score;
  score.models = richer;
  score.name = name_of(richer);
  score.held_out_rms_px = rms(errors);
  score.fitted_rms_px = rms(corner_residuals(observations, fitted));
  compare_errors(in_use, errors, score);
  compare_parameters(estimate, fitted.rig, score);
  return score;
}

}  // namespace

ModelComparison compare_models(const RigEstimate& estimate,
                               const CalibrationOptions& options,
                               int max_frames) {
  ModelComparison comparison;
  if (!estimate.evidence || !estimate.covariance || !estimate.calibration) {
    throw Error("model comparison", "the calibration has no evidence or covariance",
                "calibrate from corners");
  }
  const CalibrationEvidence& evidence = *estimate.evidence;
  const auto models = candidates(estimate.rig);
  if (models.empty()) {
    comparison.not_compared =
        "no richer model than " + name_of(models_of(estimate.rig)) + " is available";
    return comparison;
  }
  if (evidence.frames.size() < min_frames_to_compare) {
    comparison.not_compared = fmt::format("{} frames are too few, at least {} are needed",
                                          evidence.frames.size(), min_frames_to_compare);
    return comparison;
  }

  const std::vector<int> frames = evenly_spaced(evidence.frames, max_frames);
  const BoardState whole{estimate.rig, evidence.frames, evidence.T_first_board, evidence.warp_m};
  const BoardState state = at_frames(whole, frames);
  const BoardObservations observations = at_frames(evidence.observations, frames);
  HeldOut in_use;
  try {
    in_use =
        held_out_errors(observations, state,
                        problem_for(options, estimate.rig, estimate.calibration->pixel_sigma_px));
  } catch (const Error& error) {
    comparison.not_compared = std::string("with some views left out, ") + error.what();
    return comparison;
  }
  comparison.frames = static_cast<int>(frames.size());
  comparison.in_use.models = models_of(estimate.rig);
  comparison.in_use.name = name_of(comparison.in_use.models);
  comparison.in_use.held_out_rms_px = rms(in_use);
  comparison.in_use.fitted_rms_px = estimate.calibration->rms_px;
  for (const std::vector<CameraModel>& richer : models) {
    try {
      comparison.richer.push_back(score_of(richer, estimate, options, observations, state, in_use));
    } catch (const Error& error) {  // the views do not determine this model, nor a richer one
      comparison.left_out = name_of(richer) + ", " + error.fault();
      break;
    }
  }
  if (comparison.richer.empty()) comparison.not_compared = comparison.left_out;
  comparison.warnings = warnings_of(comparison);
  return comparison;
}

}  // namespace vernier::internal
