// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/views/depth_steps.h"

#include <gtest/gtest.h>

#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/image/depth_image.h"

namespace vernier::localise::internal {
namespace {

using stereo::EdgePoint;
using stereo::internal::DepthImage;

// Steps of depth lie at edges of their own image; of a map of another one, as many as by chance.
TEST(StepsAtEdges, TellAnImagesOwnMap) {
  constexpr int width = 60, height = 40;
  DepthImage depth{width, height, std::vector<float>(width * height, 3)};
  for (int y = 0; y < height; ++y) {
    for (int x = 20; x < width; ++x) depth.depth_m[y * width + x] = 2;
  }
  const auto edges_at = [](float column_px) {
    std::vector<EdgePoint> edges;
    for (int y = 0; y < height; ++y) {
      EdgePoint e{};
      e.normal.setZero();
      e.pixel_px = {column_px, static_cast<float>(y)};
      edges.push_back(e);
    }
    return edges;
  };
  const StepsAtEdges own = steps_at_edges(edges_at(19.5F), depth);
  EXPECT_EQ(own.steps, 2 * (height - 2));
  EXPECT_EQ(own.at_edges, 1);
  EXPECT_NEAR(own.by_chance, 5.0 / width, 1e-12);
  EXPECT_EQ(steps_at_edges(edges_at(40), depth).at_edges, 0);
  for (int y = 0; y < height; ++y) depth.depth_m[y * width + 19] = 0;  // a shadow
  EXPECT_LT(steps_at_edges(edges_at(19.5F), depth).steps, height);
  EXPECT_EQ(steps_at_edges({}, depth).by_chance, 0);
}

}  // namespace
}  // namespace vernier::localise::internal
