// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace vernier::internal {

/// The normalised points of one corner in two images.
struct PointPair {
  Eigen::Vector2d left, right;
};

/// The fraction of points that one plane explains within `limit` (normalised units, in the right
/// image), if each image may also be distorted by x (1 + c r²): a homography, fitted robustly, then
/// with the two c by least squares over the points near it. 0 if there is no homography.
double fraction_on_distorted_plane(const std::vector<PointPair>& points, double limit);

}  // namespace vernier::internal
