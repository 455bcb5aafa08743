// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/noise_of_estimate.h"

#include <cstddef>
#include <utility>
#include <vector>

#include "calib/board/board_aspect.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/error.h"
#include "calib/estimate/held_parameters.h"
#include "calib/noise/board_tests.h"
#include "calib/noise/camera_scales.h"
#include "calib/noise/component_tests.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/fit_corner_noise.h"
#include "calib/noise/frame_rows.h"
#include "calib/noise/restricted_likelihood.h"
#include "calib/noise/rig_knowledge.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"
#include "calib/statistics/distributions.h"

namespace vernier::internal {
namespace {

constexpr std::size_t most_points = 80;  // a field of more is decomposed for too long

BoardState state_of(const RigEstimate& estimate) {
  const CalibrationEvidence& evidence = *estimate.evidence;
  return {estimate.rig, evidence.frames, evidence.T_first_board, evidence.warp_m};
}

/// The corners at no more than `most_points` of the target, evenly spaced by number; all of them if
/// there are no more.
BoardObservations thinned(BoardObservations observations) {
  const std::size_t points = observations.target_m.size();
  if (points <= most_points) return observations;
  std::vector<bool> kept(points, false);
  for (std::size_t i = 0; i < most_points; ++i) kept[i * points / most_points] = true;
  return with_corners(std::move(observations), [&](const BoardView& view, std::size_t corner) {
    return kept[static_cast<std::size_t>(view.ids[corner])];
  });
}

}  // namespace

RestrictedLikelihood noise_likelihood(const RigEstimate& estimate,
                                      NoiseParts parts,
                                      const std::vector<BoardField>& board,
                                      CameraNoise cameras) {
  if (!estimate.evidence) {
    throw Error("corner noise", "the rig holds no evidence", "calibrate without --no-evidence");
  }
  const CalibrationEvidence& evidence = *estimate.evidence;
  const Eigen::MatrixXd free = free_directions(estimate.rig, held_parameters(estimate));
  const BoardWarp warp = evidence.warp_m.isZero(0) ? BoardWarp::known : BoardWarp::free;
  const BoardObservations observations = thinned(evidence.observations);
  std::vector<FrameRows> frames =
      frame_rows(observations, at_frames(state_of(estimate), frames_of(observations)), free, warp);
  if (cameras == CameraNoise::of_each) divide_by_camera(camera_scales(frames), frames);
  std::vector<BoardField> unknown = board;
  if (estimate.calibration && estimate.calibration->board_aspect) {
    unknown.insert(unknown.begin(), aspect_field(observations.target_m));
  }
  for (FrameRows& rows : frames) add_board_unknowns(unknown, rows);
  const Eigen::Index unknowns = frames.empty() ? 0 : frames[0].by_rig.cols();
  return {std::move(frames), evidence.observations.target_m, parts,
          knowledge_of_priors(priors_of(estimate), estimate.rig, free, unknowns)};
}

std::vector<FrameMotion> CornerNoiseEstimate::moved() const {
  constexpr double level = 0.01;
  std::vector<FrameMotion> moved;
  if (!motion || motion->p_value >= level) return moved;
  const auto tests = static_cast<double>(fit.solution.motions.size());
  for (const FrameMotion& m : fit.solution.motions) {
    if (chi_squared_survival(m.chi2, 6) * tests < level) moved.push_back(m);
  }
  return moved;
}

CornerNoiseEstimate estimate_corner_noise(const RigEstimate& estimate,
                                          NoiseParts parts,
                                          NoiseParts tested,
                                          CameraNoise cameras) {
  const LikelihoodOf likelihood_of = [&](NoiseParts fewer) {
    return noise_likelihood(estimate, fewer, {}, cameras);
  };
  const double spacing_m = point_spacing_m(estimate.evidence->observations.target_m);
  return {fit_and_test(likelihood_of, parts, tested, spacing_m)};
}

}  // namespace vernier::internal
