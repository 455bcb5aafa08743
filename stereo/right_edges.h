// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/stretch_correlation.h"

namespace vernier {

/// Edges of the right image by their pixels, to find those that a left edge may be seen as.
class RightEdges {
 public:
  RightEdges(const GreyLevels& right, const StretchOptions& options);

  /// Where the edge like `left` that crosses its row nearest to `x_px` does so; not a number if
  /// there is none in reach. Edges of the rows above and below are followed along their tangents.
  float nearest_px(const EdgePoint& left, float x_px) const;

 private:
  bool is_like(const EdgePoint& left, const EdgePoint& right) const;

  StretchOptions options_;
  float least_sine_, least_cosine_;
  int width_, height_;
  std::vector<EdgePoint> edges_;
  std::vector<int> at_pixel_;  ///< an edge's index, −1 for none
};

}  // namespace vernier
