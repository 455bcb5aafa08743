// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "stereo/canny_edges.h"
#include "stereo/edge_matcher.h"
#include "stereo/grey_levels.h"
#include "tests/support/leaf_pair.h"

namespace vernier {

using namespace vernier::stereo;

namespace {

/// The Cramér–Rao bound of an edge's disparity, px: how well the two noisy patches of 9 x 7 pixels
/// that least squares sees can tell it at all, gain, offset, stretch and shear unknown too.
double bound_px(const GreyLevels& exact, const EdgePoint& edge, double noise) {
  Eigen::Matrix<double, 5, 5> information = Eigen::Matrix<double, 5, 5>::Zero();
  for (int j = -3; j <= 3; ++j) {
    for (int i = -4; i <= 4; ++i) {
      const int x = edge.x + i, y = edge.y + j;
      const double slope =
          (8 * (exact(x + 1, y) - exact(x - 1, y)) - exact(x + 2, y) + exact(x - 2, y)) / 12;
      Eigen::Matrix<double, 5, 1> by;
      by << slope, slope * i, slope * j, exact(x, y), 1;
      information += by * by.transpose() / (2 * noise * noise);
    }
  }
  // What is known of stretch and shear beforehand (RefinementOptions::stretch_sigma).
  information(1, 1) += 1 / (0.3 * 0.3);
  information(2, 2) += 1 / (0.3 * 0.3);
  return std::sqrt(information.inverse()(0, 0));
}

TEST(EdgeMatcherBound, IsNearTheCramerRaoBoundAtEveryAngle) {
  constexpr int bins = 9, seeds = 4;
  double squares[bins] = {}, bounds[bins] = {}, count[bins] = {};
  for (int k = 0; k < seeds; ++k) {
    test::LeafPlane plane{.disparity_px = 20 + 0.37 * k};
    const std::uint64_t seed = 260 + static_cast<std::uint64_t>(k);
    const RectifiedPair pair = test::leaf_pair(plane, seed);
    const double noise = plane.noise;
    plane.noise = 0;
    const RectifiedPair exact = test::leaf_pair(plane, seed);  // the same leaves
    const std::vector<EdgePoint> edges = canny_edges(pair.left);
    const auto found = match_edges(pair, edges, {0, 40}, {.sigma_floor_px = 0});
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const EdgePoint& edge = edges[i];
      if (!found[i].refined || edge.x < 32 || edge.x > 314 || edge.y < 5 || edge.y > 234) continue;
      const double error = found[i].at.disparity_px - plane.disparity_px;
      if (std::abs(error) > 1) continue;
      const double angle = std::asin(std::min(1.0f, std::abs(edge.normal.x())));
      const auto bin = std::min(bins - 1, static_cast<int>(angle * 18 / M_PI));
      squares[bin] += error * error;
      bounds[bin] += std::pow(bound_px(exact.left, edge, noise), 2);
      ++count[bin];
    }
  }
  for (int bin = 0; bin < bins; ++bin) {
    ASSERT_GT(count[bin], 100);
    const double rms = std::sqrt(squares[bin] / count[bin]);
    const double bound = std::sqrt(bounds[bin] / count[bin]);
    const std::string name = "from_" + std::to_string(10 * bin) + "_deg";
    RecordProperty(name + "_rms_px", std::to_string(rms));
    RecordProperty(name + "_bound_px", std::to_string(bound));
    EXPECT_LT(rms / bound, 1.5) << name;
    EXPECT_GT(rms / bound, 0.9) << name;
  }
}

}  // namespace
}  // namespace vernier
