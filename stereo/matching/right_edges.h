// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matching/stretch_correlation.h"

namespace vernier::stereo::internal {

/// Edges of the right image by their pixels, to find the one that a left edge is seen as.
class RightEdges {
 public:
  RightEdges(const GreyLevels& right, const StretchOptions& options);

  /// Where the edge like `left` that crosses its row nearest to `x_px` does so; not a number if
  /// there is none in reach. Edges of the rows above and below are followed along their tangents.
  float nearest_px(const EdgePoint& left, float x_px) const;

 private:
  /// An edge that crosses its own row at x_px and others in a straight line.
  struct Crossing {
    float x_px, place_x_px, place_y_px, slope;
    Eigen::Vector2f normal;
    float strength;
  };
  bool is_like(const EdgePoint& left, const Crossing& right) const;

  float reach_px_, max_ratio_, min_cosine_;
  int width_, height_;
  std::vector<Crossing> crossings_;  ///< by row, then by pixel
  std::vector<int> from_pixel_;      ///< the first crossing from a pixel on; one more a row
};

}  // namespace vernier::stereo::internal
