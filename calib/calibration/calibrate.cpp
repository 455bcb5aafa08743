// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/calibration_problem.h"
#include "calib/calibration/change_findings.h"
#include "calib/calibration/cluster_robust_covariance.h"
#include "calib/calibration/doubted_frames.h"
#include "calib/calibration/effects.h"
#include "calib/calibration/lens_field.h"
#include "calib/calibration/minimum_variance_bound.h"
#include "calib/calibration/observation_checks.h"
#include "calib/calibration/outliers.h"
#include "calib/calibration/residual_diagnosis.h"
#include "calib/calibration/result_checks.h"
#include "calib/calibration/richer_lens_outliers.h"
#include "calib/calibration/view_checks.h"
#include "calib/camera.h"
#include "calib/camera/model_nesting.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/estimate/covariance_curvature.h"
#include "calib/estimate/held_parameters.h"
#include "calib/lens_models.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"
#include "calib/solver/linearised_cost.h"
#include "calib/solver/minimise_reprojection.h"
#include "calib/solver/normal_equations.h"
#include "calib/solver/refined_minimum.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier {

using namespace internal;

namespace {

constexpr double largest_corner_noise_px = 1;  // larger residuals indicate a fault
constexpr int few_frames = 8;                  // fewer give an uncertain scatter

/// A minimum of the cost and related quantities.
struct Solution {
  BoardObservations observations;  // without the outliers
  BoardState state;
  std::vector<CornerOutlier> outliers;
  ReprojectionProblem problem;
  ObservationDiagnosis diagnosis;  // of the observations, before they were solved
  LinearisedCost cost;             // at the state
  Eigen::MatrixXd bound;           // of the free parameters
  double data_parameters = 0;      // number determined by the corners, tr(C S_data)
  double aspect = 0;               // of the board, which the observations' target has
};

/// The normal equations and the bound at the solution's state.
void linearise(Solution& s) {
  RefinedMinimum refined;
  if (s.problem.priors.empty() && s.problem.warp == BoardWarp::known) {
    refined = refine_minimum(s.observations, s.state, s.problem.held);
    if (refined.converged) s.state = refined.state;
  }
  s.cost = linearised_cost(s.observations, s.state, s.problem);
  s.bound = minimum_variance_bound(s.cost.equations, s.cost.names);
  if (refined.converged) {  // the same with more digits
    s.bound = s.problem.pixel_sigma_px * s.problem.pixel_sigma_px * refined.free_bound;
  }
  s.data_parameters = static_cast<double>(s.cost.names.size());
  if (!s.problem.priors.empty()) {
    s.data_parameters -= (s.bound * s.cost.equations.prior_information).trace();
  }
}

/// Throws Error if there are none.
double degrees_of_freedom(const Solution& s) {
  const double nuisance =
      6 * static_cast<double>(s.state.frames.size()) + (s.problem.warp == BoardWarp::free ? 2 : 0);
  const double dof = s.cost.equations.residuals - s.data_parameters - nuisance;
  if (dof > 0) return dof;
  throw Error("calibration", "fewer corner coordinates than unknowns", "add views");
}

/// σ from the residuals, with their degrees of freedom.
double estimated_sigma(const Solution& s) {
  return s.problem.pixel_sigma_px * std::sqrt(s.cost.equations.chi2 / degrees_of_freedom(s));
}

/// Excludes outliers. Corners are assessed with a rich lens model, so that the misfit of a simple
/// model is not mistaken for wrong corners. Least squares then starts at the robust minimum of the
/// requested model, since without outliers plain least squares may reach another local minimum.
void reject_outliers(Solution& s, const CalibrationOptions& options) {
  std::optional<BoardState> robust = robust_minimum(s.observations, s.state, s.problem);
  if (robust && place_outlying_boards(s.observations, *robust)) {
    ReprojectionProblem again = s.problem;
    again.must_converge = false;
    s.state = minimise_reprojection(s.observations, *robust, again);
    robust = robust_minimum(s.observations, s.state, s.problem);
    if (!robust) s.state = minimise_reprojection(s.observations, s.state, s.problem);
  }
  if (!robust) return;
  RobustFit fit = outliers_at(s.observations, *robust);
  if (fit.outliers.empty()) return;
  if (std::optional<RobustFit> judged =
          outliers_by_richer_lenses(s.observations, *robust, fit, options)) {
    judged->state.rig = fit.state.rig;
    judged->state.warp_m = fit.state.warp_m;
    replace_poses(judged->state, fit.state);
    fit = std::move(*judged);
  }
  if (fit.outliers.empty()) return;
  const auto cameras = overrejected_cameras(s.observations, fit.inliers, s.state.rig);
  s.diagnosis.trust_warnings.insert(s.diagnosis.trust_warnings.end(), cameras.begin(),
                                    cameras.end());
  if (!cameras.empty()) return;
  s.state = minimise_reprojection(fit.inliers, fit.state, s.problem);
  s.observations = std::move(fit.inliers);
  s.outliers = std::move(fit.outliers);
}

/// The minimum of the frames that nothing is held against, with the boards of the others placed for
/// it: a frame with a gross error may keep least squares from converging. Returns whether there are
/// such frames, and enough others.
bool begin_without_doubted_frames(Solution& s) {
  const std::vector<int> sound = frames_without(s.diagnosis.frame_doubts, s.state.frames);
  if (sound.size() == s.state.frames.size() || 2 * sound.size() < s.state.frames.size()) {
    return false;
  }
  try {
    const BoardState start = minimise_reprojection(at_frames(s.observations, sound),
                                                   at_frames(s.state, sound), s.problem);
    s.state.rig = start.rig;
    s.state.warp_m = start.warp_m;
    replace_poses(s.state, start);
    place_doubted(s.diagnosis.frame_doubts, s.observations, s.state);
  } catch (const Error&) {
    return false;
  }
  return true;
}

/// From the start to the minimum, outliers excluded.
void descend(Solution& s, const CalibrationOptions& options) {
  if (options.reject_outliers && begin_without_doubted_frames(s)) {
    reject_outliers(s, options);
    if (s.outliers.empty()) s.state = minimise_reprojection(s.observations, s.state, s.problem);
    return;
  }
  try {
    s.state = minimise_reprojection(s.observations, s.state, s.problem);
  } catch (const Error&) {
    // Gauss–Newton converges slowly when residuals are large, as with wrong corners.
    if (!options.reject_outliers) throw;
    ReprojectionProblem hasty = s.problem;
    hasty.must_converge = false;
    s.state = minimise_reprojection(s.observations, s.state, hasty);
    reject_outliers(s, options);
    if (s.outliers.empty()) s.state = minimise_reprojection(s.observations, s.state, s.problem);
    return;
  }
  if (options.reject_outliers) reject_outliers(s, options);
}

Solution solve(BoardObservations observations, const CalibrationOptions& options) {
  std::vector<CameraModel> models = options.models;
  if (models.empty()) models.assign(observations.size_px.size(), options.model);
  if (models.size() != observations.size_px.size()) {
    throw Error("calibration",
                fmt::format("{} models for {} cameras", models.size(), observations.size_px.size()),
                "give one model, or one per camera");
  }
  Solution s;
  if (options.check_input) s.diagnosis = check_observations(observations, options.reject_outliers);
  s.state = start_without(s.diagnosis.frame_doubts, observations, models);
  leave_out_beyond_field(observations, s.state, options.held, problem_of(options, s.state.rig),
                         s.diagnosis.warnings);
  if (options.check_input) {
    const bool free = options.held.empty() && options.known.empty() && !options.prior;
    s.diagnosis.add(check_views(observations, s.state, {.tilts = free}));
  }
  s.state.rig = with_held_values(s.state.rig, options.held);
  s.problem = problem_of(options, s.state.rig);
  s.observations = std::move(observations);
  try {
    descend(s, options);
    linearise(s);
  } catch (const Error& error) {  // the earlier findings may be the reason
    std::vector<std::string> before = s.diagnosis.trust_warnings;
    for (const FrameDoubt& doubt : s.diagnosis.frame_doubts) before.push_back(doubt.text);
    if (before.empty()) throw;
    throw Error(error.place(),
                fmt::format("{}, perhaps because of what was seen before: {}", error.fault(),
                            fmt::join(before, "; ")),
                error.remedy());
  }
  if (options.board_aspect) {
    s.aspect = take_aspect(s.observations, s.problem, s.state);
    linearise(s);
  }
  if (options.pixel_sigma_px > 0) return s;
  if (s.problem.priors.empty()) {  // σ does not move the solution
    const double sigma = estimated_sigma(s);
    s.problem.pixel_sigma_px = sigma;
    s.cost.equations = rescaled(std::move(s.cost.equations), sigma);
    s.bound *= sigma * sigma;
    return s;
  }
  for (int round = 0; round < 20; ++round) {
    const double sigma = estimated_sigma(s);
    const bool settled = std::abs(sigma / s.problem.pixel_sigma_px - 1) < 1e-9;
    s.problem.pixel_sigma_px = sigma;
    s.state = minimise_reprojection(s.observations, s.state, s.problem);
    linearise(s);
    if (settled) break;
  }
  return s;
}

/// Trust warnings of the frames that seemed wrong at the start, and of large residuals. Frames are
/// not doubted where another lens explains nearly all.
std::vector<std::string> doubts_of_residuals(const Solution& s,
                                             double rms_px,
                                             bool look_for_causes) {
  const bool large = rms_px > largest_corner_noise_px;
  std::vector<ResidualFinding> findings;
  if (large && look_for_causes) {
    findings = diagnose_residuals(s.observations, s.state, s.problem, {.outliers = s.outliers});
  }
  std::vector<std::string> doubts;
  if (std::none_of(findings.begin(), findings.end(),
                   [](const ResidualFinding& finding) { return finding.is_lens_alone; })) {
    doubts = unrefuted(s.diagnosis.frame_doubts, s.observations, s.state, s.outliers);
  }
  if (large) doubts.push_back(residual_warning(rms_px, findings));
  return doubts;
}

double chi2_of_priors(const Solution& s) {
  double sum = 0;
  for (const RigPrior& prior : s.problem.priors) sum += prior_chi2(prior, s.state.rig);
  return sum;
}

CalibrationSummary summary_of(const Solution& s, const CalibrationOptions& options) {
  CalibrationSummary summary;
  summary.views = static_cast<int>(s.state.frames.size());
  summary.pixel_sigma_px = s.problem.pixel_sigma_px;
  summary.rms_px =
      s.problem.pixel_sigma_px * std::sqrt(s.cost.equations.chi2 / s.cost.equations.residuals);
  summary.chi2 = s.cost.equations.chi2;
  summary.dof = static_cast<int>(std::lround(degrees_of_freedom(s)));
  summary.outliers = s.outliers;
  measure_outliers(s.observations.target_m, s.state, summary.outliers);
  summary.warnings = s.diagnosis.warnings;
  summary.trust_warnings = s.diagnosis.trust_warnings;
  const auto doubts = doubts_of_residuals(s, summary.rms_px, options.check_input);
  summary.trust_warnings.insert(summary.trust_warnings.end(), doubts.begin(), doubts.end());
  for (const HeldParameter& held : options.held) summary.held.push_back(held.name);
  summary.prior_chi2 = chi2_of_priors(s);
  const auto known =
      options.known.size() + (options.prior ? options.prior->covariance.names.size() : 0);
  summary.prior_dof = static_cast<int>(known);
  return summary;
}

/// Warnings about the result.
std::vector<std::string> warnings_of(const CalibrationSummary& summary,
                                     const Eigen::MatrixXd& honest,
                                     const Solution& s) {
  std::vector<std::string> warnings;
  const Eigen::ArrayXd ratio = (honest.diagonal().array() / s.bound.diagonal().array()).sqrt();
  const double typical = std::exp(ratio.log().mean());
  if (typical >= 1.3) {
    warnings.push_back(fmt::format(
        "residuals within a view are correlated: standard deviations are {:.1f} times those "
        "of the minimum variance bound",
        typical));
  }
  const auto out = summary.outliers.size();
  const auto all = out + static_cast<std::size_t>(s.cost.equations.residuals) / 2;
  if (out > 0) {
    const auto whole = images_left_out(summary.outliers, s.observations);
    warnings.push_back(fmt::format(
        "{} of {} corners were left out as outliers{}{}", out, all,
        whole.empty() ? "" : ", with them the whole image of " + list_of(whole),
        100 * out > 2 * all ? ": so many suggest a wrong model, a bent board or blurred images"
                            : ""));
  }
  const auto frames = static_cast<double>(s.state.frames.size());
  if (frames < few_frames && frames > 1) {
    warnings.push_back(
        fmt::format("only {:.0f} views: the standard deviations themselves are uncertain by about "
                    "{:.0f} %, and "
                    "rely on the shape of the minimum variance bound; use 15 or more",
                    frames, 100 / std::sqrt(2 * (frames - 1))));
  }
  return warnings;
}

/// Doubts of residuals that corner noise could have, but that are not noise.
void doubt_structure(const Solution& s,
                     const CalibrationOptions& options,
                     CalibrationSummary& summary) {
  const bool free = s.problem.priors.empty() && s.cost.free.cols() == s.cost.free.rows();
  if (!free || summary.rms_px > largest_corner_noise_px || summary.rms_px < exact_corners_px)
    return;
  std::optional<ResidualFinding> finding;
  if (s.problem.warp == BoardWarp::known && !options.board_shape) {
    finding = bent_board_finding(s.observations, s.state);
  }
  if (!finding) finding = change_finding(s.observations, s.state, options.motion);
  if (finding) summary.trust_warnings.push_back(finding->text);
}

/// Trust warnings about the result.
void add_trust_warnings(const Solution& s,
                        const CalibrationOptions& options,
                        RigEstimate& estimate) {
  std::vector<std::string>& trust_warnings = estimate.calibration->trust_warnings;
  const auto add = [&](const std::optional<std::string>& warning) {
    if (warning) trust_warnings.push_back(*warning);
  };
  add(ill_conditioning_warning({CovarianceKind::mvb, s.cost.names, s.bound}, estimate.rig));
  if (estimate.calibration->rms_px <= largest_corner_noise_px) {
    if (options.pixel_sigma_px > 0) {
      add(noise_warning(s.cost.equations.chi2, degrees_of_freedom(s), options.pixel_sigma_px));
    }
    add(curvature_warning(estimate.rig, *estimate.covariance));
  }
  const int clusters = options.white_noise ? 0 : estimate.calibration->views;
  for (const RigPrior& prior : s.problem.priors) {
    add(prior_conflict_warning(prior, estimate.rig, *estimate.covariance_mvb,
                               estimate.covariance->matrix, clusters));
  }
}

}  // namespace

RigEstimate calibrate(BoardObservations observations, const CalibrationOptions& options) {
  check_numbers(options);
  check_and_sort(observations);
  check_effects(options, observations.size_px.size());
  Solution s = solve(std::move(observations), options);
  CalibrationSummary summary = summary_of(s, options);
  if (options.check_input) doubt_structure(s, options, summary);
  if (has_effects(options) || options.board_aspect) {
    move_to_effects(options, s.observations, s.problem, s.state, s.cost, summary);
    s.bound = minimum_variance_bound(s.cost.equations, s.cost.names);
    summary.prior_chi2 = chi2_of_priors(s);
    if (summary.board_aspect) summary.board_aspect->value += s.aspect;
  }
  RigEstimate estimate;
  estimate.rig = s.state.rig;
  const std::vector<std::string> names = parameter_names(s.state.rig);
  const auto expand = [&](const Eigen::MatrixXd& C) -> Eigen::MatrixXd {
    return s.cost.free * C * s.cost.free.transpose();
  };
  estimate.covariance_mvb = expand(s.bound);
  const Covariance honest =
      options.white_noise
          ? Covariance{CovarianceKind::mvb, s.cost.names, s.bound}
          : cluster_robust_covariance(s.cost.equations, s.bound, s.cost.names,
                                      {.bound_of = has_effects(options) ? BoundOf::random_effects
                                                                        : BoundOf::white_noise});
  estimate.covariance = Covariance{honest.kind, names, expand(honest.matrix)};
  if (summary.board_aspect) {
    add_scale_of_aspect(estimate.rig, summary.board_aspect->value, estimate.covariance->matrix);
  }
  estimate.calibration = std::move(summary);
  const auto more = warnings_of(*estimate.calibration, honest.matrix, s);
  auto& warnings = estimate.calibration->warnings;
  warnings.insert(warnings.end(), more.begin(), more.end());
  if (options.check_input) {
    const auto folds = inversion_warnings(estimate.rig);
    warnings.insert(warnings.end(), folds.begin(), folds.end());
    add_trust_warnings(s, options, estimate);
  }
  estimate.evidence = CalibrationEvidence{
      std::move(s.observations), s.state.frames, s.state.T_first_board, s.state.warp_m, {}, {}};
  if (options.prior) estimate.evidence->priors.push_back(*options.prior);
  if (!options.known.empty()) {
    estimate.evidence->priors.push_back(gaussian_prior_of(estimate.rig, options.known));
  }
  return estimate;
}

}  // namespace vernier
