// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/pair_corners.h"

#include <Eigen/Core>
#include <vector>

#include "calib/error.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "stereo/corners/corner_match.h"
#include "stereo/corners/described_corners.h"
#include "stereo/grey_levels.h"

namespace vernier::localise {

namespace {

/// The right pixel is matched to the left one with an error of its own; both share what moves the
/// corner from view to view.
Eigen::Matrix4d covariance_of(const stereo::internal::CornerMatch& match,
                              const PairCornersOptions& options) {
  const double common = options.view_sigma_px * options.view_sigma_px;
  const double matching = 2 * match.sigma_px * match.sigma_px +  // of right less left
                          options.pair_sigma_px * options.pair_sigma_px;
  const Eigen::Matrix2d I = Eigen::Matrix2d::Identity();
  Eigen::Matrix4d C;
  C << common * I, common * I, common * I, (common + matching) * I;
  return C;
}

}  // namespace

std::vector<StereoCorner> corners_of_pair(const Rig& rig,
                                          const Eigen::MatrixXd& covariance,
                                          const stereo::GreyLevels& left,
                                          const stereo::GreyLevels& right,
                                          const PairCornersOptions& options) {
  if (rig.cameras.size() != 2) {
    throw Error("rig", "does not have two cameras", "give a stereo rig");
  }
  const int n = parameter_count(rig);
  std::vector<StereoCorner> corners;
  for (auto& [match, descriptor] : stereo::internal::described_corners(
           rig, covariance.size() > 0 ? covariance : Eigen::MatrixXd::Zero(n, n), left, right,
           {options.corners, options.cells, options.nearest_m})) {
    corners.push_back(
        {match.left_px, match.right_px, covariance_of(match, options), std::move(descriptor)});
  }
  return corners;
}

}  // namespace vernier::localise
