// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "stereo/canny_edges.h"

namespace vernier::test {

using namespace vernier::stereo;

/// An upright edge that crosses row y at row_x.
inline EdgePoint edge_at(float row_x, int y) {
  EdgePoint edge;
  edge.pixel_px = {row_x, static_cast<float>(y)};
  edge.normal = {1, 0};
  edge.x = static_cast<int>(std::lround(row_x));
  edge.y = y;
  edge.row_x_px = row_x;
  return edge;
}

}  // namespace vernier::test
