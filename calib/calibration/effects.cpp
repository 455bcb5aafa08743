// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/effects.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/shown_text.h"
#include "calib/board/board_aspect.h"
#include "calib/board/board_warp.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/calibration/change_findings.h"
#include "calib/calibration/result_checks.h"
#include "calib/error.h"
#include "calib/noise/board_tests.h"
#include "calib/noise/camera_scales.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/fit_corner_noise.h"
#include "calib/noise/noise_of_estimate.h"
#include "calib/noise/random_effects.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/solver/linearised_cost.h"
#include "calib/solver/reprojection_problem.h"
#include "calib/statistics/distributions.h"

namespace vernier::internal {
namespace {

constexpr double level = 0.01;        // of the tests
constexpr double bend_level = 0.005;  // its p-values are a little too small
constexpr double aspect_level = 0.005, told_aspect = 5e-4;
constexpr int fewest_views_of_effects = 8, fewest_views_of_bends = 4;
constexpr std::size_t most_points_of_effects = 150;
constexpr const char* no_minimum =
    "no minimum with the board's shape, motion and aspect was found; calibrate without "
    "--board-shape, --motion and --board-aspect";

/// The components and the shape of a minimum, warp and the rest of it together.
CalibrationEffects effects_of(const EffectsMinimum& minimum,
                              const std::vector<Eigen::Vector3d>& target_m) {
  const CornerNoise& noise = minimum.noise.noise;
  CalibrationEffects effects{noise.white_px,      noise.field_px,       noise.field_length_m,
                             noise.motion_rad,    noise.motion_m,       noise.motion_baseline_m,
                             noise.shape_plane_m, noise.shape_height_m, {}};
  if (minimum.shape_m.size() == 0) return effects;
  const std::vector<Eigen::Vector3d> warped = warped_target(target_m, minimum.state.warp_m);
  for (std::size_t i = 0; i < target_m.size(); ++i) {
    effects.shape_m.emplace_back(warped[i] - target_m[i] +
                                 minimum.shape_m.segment<3>(3 * static_cast<Eigen::Index>(i)));
  }
  return effects;
}

/// Why the effects are not looked for; empty if they are.
std::string reason_not_to_test(const RigEstimate& usual, const CalibrationOptions& options) {
  const CalibrationSummary& summary = *usual.calibration;
  if (options.warp == BoardWarp::free) return "the board's warp is estimated";
  if (options.pixel_sigma_px > 0 || options.white_noise) return "the noise is given";
  if (summary.views < fewest_views_of_bends) {
    return fmt::format("{}; it takes {}", counted(summary.views, "view"), fewest_views_of_bends);
  }
  for (const std::string& doubt : summary.trust_warnings) {
    if (!doubt.starts_with(bent_board_doubt)) return "the calibration is doubtful";
  }
  if (summary.rms_px < exact_corners_px) return "the corners are exact";
  const std::size_t points = usual.evidence->observations.target_m.size();
  if (points > most_points_of_effects) {
    return fmt::format("a board of {} points takes too long; --board-shape estimates its shape",
                       points);
  }
  return {};
}

/// Nothing where the corners do not determine it.
std::optional<AspectEstimate> tested_aspect(const RigEstimate& usual) {
  const std::vector<Eigen::Vector3d>& target_m = usual.evidence->observations.target_m;
  std::vector<BoardField> unknowns = bend_fields(target_m);
  unknowns.push_back(aspect_field(target_m));
  try {
    const BoardTest all = board_test(usual, unknowns);
    return AspectEstimate{all.value.tail<1>()[0],
                          std::sqrt(all.covariance.bottomRightCorner<1, 1>()(0, 0))};
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

bool has_effects(const CalibrationOptions& options) {
  return options.board_shape || options.motion;
}

void check_effects(const CalibrationOptions& options, std::size_t cameras) {
  if (!has_effects(options) && !options.board_aspect) return;
  if (options.warp == BoardWarp::free) {
    throw Error("--warp", "is not estimated beside --board-shape, --motion or --board-aspect",
                "leave it out; --board-shape contains it");
  }
  if (options.pixel_sigma_px > 0) {
    throw Error("--pixel-sigma", "is estimated with --board-shape, --motion and --board-aspect",
                "leave it out");
  }
  if (options.motion && cameras < 2) {
    throw Error("--motion", "is seen by two cameras; there is one", "leave it out");
  }
}

void add_scale_of_aspect(const Rig& rig, double aspect, Eigen::MatrixXd& covariance) {
  Eigen::VectorXd by_scale = Eigen::VectorXd::Zero(covariance.rows());
  for (std::size_t c = 1; c < rig.cameras.size(); ++c) {
    by_scale.segment<3>(pose_index(rig, static_cast<int>(c)) + 3) = rig.T_camera_first[c].t;
  }
  covariance += 0.25 * aspect * aspect * by_scale * by_scale.transpose();
}

double take_aspect(BoardObservations& observations,
                   const ReprojectionProblem& problem,
                   BoardState& state) {
  const EffectsMinimum minimum =
      minimise_with_effects(observations, state, problem.held, problem.priors,
                            {.field = false, .motion = false}, BoardAspect::free);
  state = minimum.state;
  observations.target_m = stretched_target(std::move(observations.target_m), minimum.aspect);
  return minimum.aspect;
}

void move_to_effects(const CalibrationOptions& options,
                     BoardObservations& observations,
                     const ReprojectionProblem& problem,
                     BoardState& state,
                     LinearisedCost& cost,
                     CalibrationSummary& summary) {
  const EffectsMinimum minimum =
      minimise_with_effects(observations, state, problem.held, problem.priors,
                            {.field = has_effects(options),
                             .motion = options.motion,
                             .shape = options.board_shape,
                             .baseline_motion = options.motion && options.baseline_motion},
                            options.board_aspect ? BoardAspect::free : BoardAspect::known);
  state = minimum.state;
  cost.free = minimum.free;
  cost.equations = minimum.equations;
  if (options.board_aspect) {
    observations.target_m = stretched_target(std::move(observations.target_m), minimum.aspect);
    summary.board_aspect = AspectEstimate{minimum.aspect, minimum.aspect_sigma};
  }
  if (has_effects(options)) summary.effects = effects_of(minimum, observations.target_m);
  if (minimum.converged) return;
  summary.trust_warnings.emplace_back(no_minimum);
}

double EffectsTest::aspect_p_value() const {
  if (!aspect) return 1;
  const double z = aspect->value / aspect->sigma;
  return chi_squared_survival(z * z, 1);
}
bool EffectsTest::has_aspect() const { return aspect_p_value() < aspect_level; }
bool EffectsTest::tells_aspect() const { return aspect && aspect->sigma < told_aspect; }
bool EffectsTest::has_bend() const { return bend && bend->p_value < bend_level; }
bool EffectsTest::has_shape() const { return has_bend() || (shape && shape->p_value < level); }
bool EffectsTest::has_motion() const { return motion && motion->p_value < level; }

EffectsTest test_effects(const RigEstimate& usual, const CalibrationOptions& options) {
  EffectsTest test;
  test.not_tested = reason_not_to_test(usual, options);
  if (!test.not_tested.empty()) return test;
  const int views = usual.calibration->views;
  if (views < fewest_views_of_effects) {
    test.bend = board_test(usual, bend_fields(usual.evidence->observations.target_m));
    test.not_tested =
        fmt::format("{}; it takes {}", counted(views, "view"), fewest_views_of_effects);
    return test;
  }
  const bool moves = usual.rig.cameras.size() > 1;
  const NoiseParts all{.motion = moves, .shape = true, .baseline_motion = moves};
  const CornerNoiseEstimate found =
      estimate_corner_noise(usual, all, {.field = false, .shape = true}, CameraNoise::of_each);
  test.shape = found.shape;
  test.motion = found.motion;
  test.isotropy = found.isotropy;
  test.along_baseline = found.is_along_baseline();
  return test;
}

RigEstimate with_found_effects(RigEstimate usual,
                               const BoardObservations& observations,
                               CalibrationOptions& options,
                               EffectsTest& test) {
  const auto keep_usual = [&](const std::string& why) {
    options.board_shape = options.motion = false;
    options.board_aspect = usual.calibration->board_aspect.has_value();
    usual.calibration->warnings.push_back("calibrated without the board's shape and motion: " +
                                          why);
    return usual;
  };
  try {
    if (reason_not_to_test(usual, options).empty()) test.aspect = tested_aspect(usual);
    if (test.has_aspect()) {
      options.board_aspect = true;
      usual = calibrate(observations, options);
    }
    const std::optional<AspectEstimate> aspect = test.aspect;
    test = test_effects(usual, options);
    test.aspect = aspect;
    options.board_shape = test.has_shape();
    options.motion = test.has_motion();
    options.baseline_motion = options.motion && test.along_baseline;
    if (!has_effects(options)) return usual;
    RigEstimate estimate = calibrate(observations, options);
    for (const std::string& doubt : estimate.calibration->trust_warnings) {
      if (doubt == no_minimum) return keep_usual("they lead to no minimum");
    }
    return estimate;
  } catch (const Error& error) {
    return keep_usual(error.what());
  }
}

}  // namespace vernier::internal
