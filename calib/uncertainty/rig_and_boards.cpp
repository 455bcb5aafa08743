// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/rig_and_boards.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "calib/board_state.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/noise/rig_knowledge.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"
#include "calib/solver/normal_equations.h"
#include "calib/statistics/scaled_root.h"
#include "calib/uncertainty/joint_information.h"

namespace vernier {

using namespace internal;

namespace {

/// tr(C_bound P), the part of the parameters that the priors P determine.
double prior_parameters(const RigEstimate& estimate) {
  const Eigen::Index n = parameter_count(estimate.rig);
  const RigKnowledge known =
      knowledge_of_priors(priors_of(estimate), estimate.rig, Eigen::MatrixXd::Identity(n, n), n);
  return known.information.size() == 0 ? 0 : (*estimate.covariance_mvb * known.information).trace();
}

/// Number of parameters that the views determine, tr(C_bound S): all those with a variance, minus
/// what a prior contributes.
double data_parameters(const RigEstimate& estimate, double directions) {
  const CalibrationEvidence& evidence = *estimate.evidence;
  if (estimate.calibration->prior_dof == 0) return directions;
  if (estimate.calibration->effects) return directions - prior_parameters(estimate);
  const ReducedNormalEquations equations = reduced_normal_equations(
      evidence.observations,
      {estimate.rig, evidence.frames, evidence.T_first_board, evidence.warp_m},
      estimate.calibration->pixel_sigma_px,
      evidence.warp_m.isZero(0) ? BoardWarp::known : BoardWarp::free);
  return (*estimate.covariance_mvb * equations.information).trace();
}

/// φ above.
double mean_inflation(const RigEstimate& estimate) {
  const ScaledRoot bound(*estimate.covariance_mvb);
  const auto p = static_cast<double>(bound.white.rows());
  const double d = data_parameters(estimate, p);
  if (!(d > 1e-3)) return 1;  // the views have no information: nothing to inflate
  const double trace =
      (bound.white * estimate.covariance->matrix * bound.white.transpose()).trace();
  return std::max(0.0, (trace - (p - d)) / d);
}

ConditionalBoardPoses poses_given_rig(const RigEstimate& estimate) {
  const CalibrationEvidence& evidence = *estimate.evidence;
  const BoardState state{estimate.rig, evidence.frames, evidence.T_first_board, evidence.warp_m};
  const std::optional<CalibrationEffects>& effects = estimate.calibration->effects;
  if (!effects) return conditional_board_poses(evidence.observations, state);
  return conditional_board_poses(evidence.observations, state, *effects,
                                 estimate.calibration->pixel_sigma_px);
}

}  // namespace

RigAndBoards rig_and_boards(const RigEstimate& estimate,
                            CovarianceChoice choice,
                            const std::string& place) {
  if (!estimate.evidence || estimate.evidence->observations.views.empty()) {
    throw Error(place, "it holds no views of a board, so the poses of the board are unknown",
                "calibrate from views of a board, without --no-evidence");
  }
  if (!estimate.calibration || !(estimate.calibration->pixel_sigma_px > 0)) {
    throw Error(place, "its pixel noise is unknown", "give calibration.pixel_sigma_px above 0");
  }
  const CalibrationEvidence& evidence = *estimate.evidence;
  RigAndBoards joint;
  joint.rig = estimate.rig;
  joint.frames = evidence.frames;
  joint.T_first_board = evidence.T_first_board;
  joint.rig_covariance = required_covariance(estimate, choice, place).matrix;
  joint.given_rig = std::make_shared<const ConditionalBoardPoses>(poses_given_rig(estimate));
  double inflation = 1;
  if (choice == CovarianceChoice::honest && estimate.covariance_mvb &&
      estimate.covariance->kind != CovarianceKind::mvb) {
    inflation = mean_inflation(estimate);
  }
  joint.board_sigma_px = estimate.calibration->pixel_sigma_px * std::sqrt(inflation);
  return joint;
}

}  // namespace vernier
