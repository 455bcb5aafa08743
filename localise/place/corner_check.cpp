// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/place/corner_check.h"

#include <Eigen/Cholesky>

#include "calib/error.h"
#include "localise/place.h"

namespace vernier::localise::internal {

void check_corners(std::span<const StereoCorner> corners, const std::string& place) {
  for (const StereoCorner& corner : corners) {
    if (corner.left_px.allFinite() && corner.right_px.allFinite() &&
        corner.covariance_px2.allFinite() && corner.covariance_px2.llt().info() == Eigen::Success) {
      continue;
    }
    throw Error(place, "a corner has a pixel that is not a number, or a covariance that is none",
                "give finite pixels and positive definite covariances");
  }
}

}  // namespace vernier::localise::internal
