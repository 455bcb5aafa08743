// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/effects.h"

#include <Eigen/Core>
#include <cstddef>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/error.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/random_effects.h"
#include "calib/rig_estimate.h"
#include "calib/solver/linearised_cost.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {
namespace {

/// The components and the shape of a minimum.
CalibrationEffects effects_of(const EffectsMinimum& minimum) {
  const CornerNoise& noise = minimum.noise.noise;
  CalibrationEffects effects{
      noise.white_px, noise.field_px,      noise.field_length_m, noise.motion_rad,
      noise.motion_m, noise.shape_plane_m, noise.shape_height_m, {}};
  for (Eigen::Index i = 0; i + 2 < minimum.shape_m.size(); i += 3) {
    effects.shape_m.emplace_back(minimum.shape_m.segment<3>(i));
  }
  return effects;
}

}  // namespace

bool has_effects(const CalibrationOptions& options) {
  return options.board_shape || options.motion;
}

void check_effects(const CalibrationOptions& options, std::size_t cameras) {
  if (!has_effects(options)) return;
  if (options.warp == BoardWarp::free) {
    throw Error("--warp", "is not estimated beside --board-shape or --motion",
                "give --board-shape alone, which contains it");
  }
  if (options.pixel_sigma_px > 0) {
    throw Error("--pixel-sigma",
                "is one of the components that --board-shape and --motion estimate",
                "leave it out");
  }
  if (options.motion && cameras < 2) {
    throw Error("--motion", "is seen by two cameras; there is one", "leave it out");
  }
}

void move_to_effects(const CalibrationOptions& options,
                     const BoardObservations& observations,
                     const ReprojectionProblem& problem,
                     BoardState& state,
                     LinearisedCost& cost,
                     CalibrationSummary& summary) {
  const EffectsMinimum minimum =
      minimise_with_effects(observations, state, problem.held, problem.priors,
                            {.motion = options.motion, .shape = options.board_shape});
  state = minimum.state;
  cost.free = minimum.free;
  cost.equations = minimum.equations;
  summary.effects = effects_of(minimum);
  if (minimum.converged) return;
  summary.trust_warnings.push_back(
      "no minimum with the board's shape and motion was found; calibrate without --board-shape "
      "and --motion");
}

}  // namespace vernier::internal
