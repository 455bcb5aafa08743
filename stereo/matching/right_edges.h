// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matching/stretch_correlation.h"

namespace vernier::stereo::internal {

/// Right edge points indexed by pixel, to find the one that corresponds to a left edge point.
class RightEdges {
 public:
  RightEdges(const GreyLevels& right, const StretchOptions& options);

  /// Where the compatible edge that crosses the row of `left` nearest to `x_px` crosses it; NaN if
  /// there is none within reach. Edges of the rows above and below are extended along their
  /// tangents.
  float nearest_px(const EdgePoint& left, float x_px) const;

 private:
  /// An edge point that crosses its own row at x_px and adjacent rows along its tangent.
  struct Crossing {
    float x_px, place_x_px, place_y_px, slope;
    Eigen::Vector2f normal;
    float strength;
  };
  bool is_like(const EdgePoint& left, const Crossing& right) const;

  float reach_px_, max_ratio_, min_cosine_;
  int width_, height_;
  std::vector<Crossing> crossings_;  ///< by row, then by pixel
  /// Index of the first crossing at or after a pixel; one extra entry per row.
  std::vector<int> from_pixel_;
};

}  // namespace vernier::stereo::internal
