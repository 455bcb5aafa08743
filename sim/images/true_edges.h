// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>
#include <vector>

#include "sim/images/image_truth.h"
#include "sim/images/wire_paint.h"
#include "sim/visibility.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

/// Why an edge ends where it does in the left image.
enum class EdgeEnd {
  corner,    ///< there the segment of the wire frame ends
  occluded,  ///< a nearer surface hides the rest from an eye: a T-junction
  border,    ///< of an image, or the limits of range
};
std::string_view name(EdgeEnd end);

/// A part of a segment of the wire frame that both rectified eyes see, exactly.
struct TrueEdge {
  stereo::ImageSegment left_px;          ///< rectified
  std::array<double, 2> disparity_px{};  ///< at both ends
  std::array<EdgeEnd, 2> ends{};
  std::array<double, 2> along{};  ///< t of the ends on the segment
  std::array<int, 2> of_eye{};    ///< the line of each eye that it is a part of
  int segment = 0;                ///< index in the world
  EdgeAppearance appearance = EdgeAppearance::border;
  double depth_m = 0;  ///< of its middle

  stereo::ImageSegment right_px() const;
  /// Angle to the rows, [0, π/2].
  double angle_rad() const;
};

/// Visible edges of a pair.
struct TrueEdges {
  std::vector<TrueEdge> both;  ///< at least min_length_px in the left image
  std::array<std::vector<stereo::ImageSegment>, 2>
      of_eye;  ///< all that each eye sees, of any length
};

/// By exact removal of hidden lines (sim/visibility.h) for the rectified cameras.
TrueEdges true_edges(const Visibility& visibility,
                     const std::vector<EdgeAppearance>& appearances,
                     const RectifiedView& view,
                     const VisibilityOptions& options = {});

}  // namespace vernier::sim::internal
