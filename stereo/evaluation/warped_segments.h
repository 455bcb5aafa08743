// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "stereo/edges/image_edges.h"
#include "stereo/segment.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {

/// A point of a left segment, mapped to the right image by the ground truth.
struct WarpedPoint {
  Eigen::Vector2d right_px;  ///< at a discontinuity by the foreground's disparity …
  Eigen::Vector2d other_px;  ///< … and by the smallest disparity nearby; elsewhere the same
  double along_px = 0;       ///< from the segment's end a, in the left image
  bool outline = false;      ///< within 2 px of a discontinuity or of unknown disparity
};

/// A left segment, mapped to the right image.
struct WarpedSegment {
  int segment = 0;                  ///< index into the left segments
  Eigen::Vector2d left_px;          ///< midpoint in the left image
  double spacing_px = 0;            ///< length in the left image per point
  std::vector<WarpedPoint> points;  ///< points visible in the right image, from a to b
  /// Unit, in the right image; the normal points to the brighter side.
  Eigen::Vector2d direction, normal;
  /// Predicted ends, from a straight line d(s) = d_0 + d_1 s through the disparities of the points
  /// away from discontinuities (a straight edge in space has one). Empty if the line does not fit,
  /// or an end is more than 3 px beyond the visible points and the reach of its corner.
  std::optional<ImageSegment> ends;
};

struct WarpOptions {
  double border_px = 4;  ///< points closer to the right image border are skipped
  int min_points = 6;    ///< segments with fewer visible points are dropped
  /// Shorter segments are dropped: the simulator does not use them as features.
  double min_length_px = 10;
  double max_rms_px = 0.4;  ///< of the disparities from their line, for the ends
};

/// The left segments, moved by u_right = u_left − d of the ground truth. Points with unknown truth
/// or not visible in the right image are dropped. Throws Error for a truth of another size.
std::vector<WarpedSegment> warped_segments(const ImageEdges& left,
                                           const StereoTruth& truth,
                                           const WarpOptions& options = {});

}  // namespace vernier::stereo::internal
