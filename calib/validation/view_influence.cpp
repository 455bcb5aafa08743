// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/validation/view_influence.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "calib/base/decompositions.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/error.h"
#include "calib/rig_estimate.h"
#include "calib/solver/normal_equations.h"
#include "calib/statistics/scaled_root.h"

namespace vernier::internal {
namespace {

/// Number of corners in the views of each frame.
std::vector<int> corners_by_frame(const CalibrationEvidence& evidence, const std::string& place) {
  if (evidence.T_first_board.size() != evidence.frames.size()) {
    throw Error(place, "its evidence does not have one board pose per frame", "calibrate again");
  }
  std::vector<int> corners(evidence.frames.size());
  for (const BoardView& view : evidence.observations.views) {
    corners[frame_index(evidence.frames, view.frame)] += static_cast<int>(view.ids.size());
  }
  return corners;
}

}  // namespace

std::vector<ViewInfluence> view_influence(const ReducedNormalEquations& equations,
                                          const Eigen::MatrixXd& bound) {
  constexpr double decides_alone = 1 - 1e-6;
  const Eigen::MatrixXd L = ScaledRoot(bound).root;
  std::vector<ViewInfluence> influences;
  for (std::size_t f = 0; f < equations.frame_information.size(); ++f) {
    ViewInfluence one;
    const Eigen::VectorXd u = L.transpose() * equations.scores.col(static_cast<Eigen::Index>(f));
    const Eigen::MatrixXd H = L.transpose() * equations.frame_information[f] * L;
    const SymmetricEigen eigen(0.5 * (H + H.transpose()));
    const Eigen::ArrayXd h = eigen.eigenvalues().array().max(0.0).min(1.0);
    const Eigen::MatrixXd& V = eigen.eigenvectors();
    one.leverage = H.trace();
    one.largest_share = h.size() > 0 ? h.maxCoeff() : 0;
    one.delta = L * u;
    one.influence = u.norm();
    one.expected_influence = std::sqrt((h * (1 - h)).sum());
    one.leave_one_out_influence = std::numeric_limits<double>::infinity();
    if (one.largest_share < decides_alone) {
      const Eigen::VectorXd without = V * ((V.transpose() * u).array() / (1 - h)).matrix();
      one.leave_one_out_influence = without.norm();
      one.leave_one_out_delta = L * without;
    }
    influences.push_back(std::move(one));
  }
  return influences;
}

std::vector<ViewInfluence> view_influence(const RigEstimate& estimate, const std::string& place) {
  if (!estimate.evidence) {
    throw Error(place, "it has no evidence, so the influence of its views is unknown",
                "write it with vernier calibrate, without --no-evidence");
  }
  if (!estimate.calibration || !(estimate.calibration->pixel_sigma_px > 0)) {
    throw Error(place, "its pixel noise is unknown", "give calibration.pixel_sigma_px above 0");
  }
  const CalibrationEvidence& evidence = *estimate.evidence;
  const double sigma = estimate.calibration->pixel_sigma_px;
  const std::vector<int> corners = corners_by_frame(evidence, place);
  const ReducedNormalEquations equations = reduced_normal_equations(
      evidence.observations,
      {estimate.rig, evidence.frames, evidence.T_first_board, evidence.warp_m}, sigma,
      evidence.warp_m.isZero(0) ? BoardWarp::known : BoardWarp::free);
  auto influences =
      view_influence(equations, required_covariance(estimate, CovarianceChoice::mvb, place).matrix);
  for (std::size_t f = 0; f < influences.size(); ++f) {
    influences[f].frame = evidence.frames[f];
    influences[f].corners = corners[f];
  }
  for (std::size_t k = 0; k < influences.size(); ++k) {
    influences[k].rms_px =
        sigma * std::sqrt(equations.frame_chi2[k] / (2 * std::max(1, influences[k].corners)));
  }
  return influences;
}

}  // namespace vernier::internal
