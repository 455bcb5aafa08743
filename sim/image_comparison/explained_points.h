// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/edges/image_edges.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

struct ExplainOptions {
  double across_px = 3;      ///< maximum distance of a point from a line that explains it …
  double turned_rad = 0.44;  ///< … and angle between its normal and that of the line (25°)
  double beyond_px = 1;      ///< … and distance beyond the line's ends
  /// A point explains all lines that are at most this much farther than the nearest: edges that
  /// coincide in the image are one edge there.
  double alike_px = 0.75;
};

/// A detected point on a true line.
struct PointOnLine {
  int point = 0;         ///< index into the image's points
  double along_px = 0;   ///< from the line's end a
  double across_px = 0;  ///< along normal_of(line)
};

/// Detected edge points put down to what the world has there.
struct ExplainedPoints {
  std::vector<std::vector<PointOnLine>> of_line;  ///< by line, ordered along it
  std::vector<char> explained;                    ///< one per point: 1 if any line explains it
};

/// The line's unit normal, of positive PointOnLine::across_px: the direction turned by 90°.
Eigen::Vector2d normal_of(const stereo::ImageSegment& line);

/// Every point goes to the nearest line that it fits; polarity does not matter.
ExplainedPoints explained_points(const stereo::internal::ImageEdges& edges,
                                 const std::vector<stereo::ImageSegment>& lines,
                                 const ExplainOptions& options = {});

}  // namespace vernier::sim::internal
