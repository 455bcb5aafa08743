// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/odometry.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/odometry/estimated_step.h"
#include "localise/odometry/step_consensus.h"
#include "localise/odometry/step_refinement.h"
#include "localise/place.h"
#include "localise/place/corner_check.h"

namespace vernier::localise {

using namespace internal;

namespace {

void check(const Rig& rig,
           std::span<const StereoCorner> from,
           std::span<const StereoCorner> to,
           std::span<const CornerLink> links,
           const StepOptions& options) {
  if (rig.cameras.size() != 2 || rig.T_camera_first.size() != 2) {
    throw Error("rig", "does not have two cameras", "give a stereo rig");
  }
  const auto is_probability = [](double p) { return p > 0 && p < 1; };
  if (!is_probability(options.gate_probability) || !is_probability(options.confidence) ||
      options.max_draws < 1 || options.min_inliers < 4) {
    throw Error("odometry", "an option is out of range",
                "give probabilities between 0 and 1, a draw or more, and 4 inliers or more");
  }
  const Eigen::Index parameters = options.calibration.rows();
  if (options.calibration.size() > 0 &&
      (parameters != parameter_count(rig) || options.calibration.cols() != parameters ||
       !options.calibration.allFinite())) {
    throw Error("odometry", "the covariance is not of the rig's parameters",
                "give the covariance of the rig, or none");
  }
  for (const auto corners : {from, to}) check_corners(corners, "odometry");
  for (const CornerLink& link : links) {
    if (link.from >= 0 && static_cast<std::size_t>(link.from) < from.size() && link.to >= 0 &&
        static_cast<std::size_t>(link.to) < to.size()) {
      continue;
    }
    throw Error("odometry", "a link names a corner that is not there",
                "give indices into the corners of both moments");
  }
}

Eigen::Matrix<double, 6, 6> covariance_of(const std::vector<CornerInfluence>& influences) {
  Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero();
  for (const CornerInfluence& of : influences) {
    sum += of.from * of.from.transpose() + of.to * of.to.transpose() +
           of.residual * of.residual.transpose();
  }
  return 0.5 * (sum + sum.transpose());
}

}  // namespace

namespace internal {

std::optional<EstimatedStep> estimated_step(const Rig& rig,
                                            std::span<const StereoCorner> from,
                                            std::span<const StereoCorner> to,
                                            std::span<const CornerLink> links,
                                            const StepOptions& options) {
  check(rig, from, to, links, options);
  const std::vector<TriangulatedLink> placed = triangulated_links(rig, from, to, links, options);
  const std::optional<Pose> agreed = consensus(rig, placed, options);
  if (!agreed) return std::nullopt;

  const std::optional<SettledStep> settled = settled_step({rig, rig}, placed, *agreed, options);
  if (!settled) return std::nullopt;
  const auto& [refined, chosen] = *settled;
  const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> information(refined.information);
  if (information.info() != Eigen::Success || !information.isPositive()) return std::nullopt;

  EstimatedStep estimated;
  MotionStep& step = estimated.step;
  step.T_from_to = refined.T_from_to;
  step.links = static_cast<int>(links.size());
  for (const int i : chosen) step.inliers.push_back(placed[static_cast<std::size_t>(i)].link);
  step.chi2 = refined.total_chi2();
  step.dof = 5 * static_cast<int>(chosen.size()) - 6;
  const std::vector<LinkedCorner> agreeing = corners_at(placed, chosen);
  estimated.influences = corner_influences(rig, agreeing, refined);
  step.covariance = covariance_of(estimated.influences);
  if (!step.covariance.allFinite()) return std::nullopt;
  if (options.with_rig) step.by_rig = step_by_rig(rig, agreeing, refined);
  return estimated;
}

}  // namespace internal

std::optional<MotionStep> estimate_step(const Rig& rig,
                                        std::span<const StereoCorner> from,
                                        std::span<const StereoCorner> to,
                                        std::span<const CornerLink> links,
                                        const StepOptions& options) {
  std::optional<EstimatedStep> estimated = estimated_step(rig, from, to, links, options);
  if (!estimated) return std::nullopt;
  return std::move(estimated->step);
}

}  // namespace vernier::localise
