// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "stereo/edges/image_edges.h"
#include "stereo/segment.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {

/// A point of a left segment where the truth puts it in the right image.
struct WarpedPoint {
  Eigen::Vector2d right_px;  ///< at a step of the truth by the foreground's disparity …
  Eigen::Vector2d other_px;  ///< … and by the least one about it; elsewhere the same
  double along_px = 0;       ///< from the segment's end a, in the left image
  bool outline = false;      ///< within 2 px of a step, or beside something not known
};

/// A straight edge of the left image as the right image should show it.
struct WarpedSegment {
  int segment = 0;                    ///< its place in the list of left segments
  Eigen::Vector2d left_px;            ///< its middle in the left image
  double spacing_px = 0;              ///< length in the left image that each point stands for
  std::vector<WarpedPoint> points;    ///< those that the right image should show, from a to b
  Eigen::Vector2d direction, normal;  /// unit, in the right image; the normal to the brighter side
  /// Where its ends should be, by the straight line d(s) = d_0 + d_1 s through the disparities of
  /// its points away from steps (a straight edge of space has one); nothing where that does not
  /// fit, or an end is farther than 3 px beyond the points shown and its corner's reach.
  std::optional<ImageSegment> ends;
};

struct WarpOptions {
  double border_px = 4;       ///< what falls nearer to the right image's border is not asked for
  int min_points = 6;         ///< segments with fewer points to be shown are left out
  double min_length_px = 10;  ///< and shorter ones, which are no features to the simulator
  double max_rms_px = 0.4;    ///< of the disparities from their line, for the ends
};

/// The left image's segments, moved by u_right = u_left − d of the truth. Points that the truth
/// does not know or that the right image does not show are left out. Throws Error for a truth of
/// another size.
std::vector<WarpedSegment> warped_segments(const ImageEdges& left,
                                           const StereoTruth& truth,
                                           const WarpOptions& options = {});

}  // namespace vernier::stereo::internal
