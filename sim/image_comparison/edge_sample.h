// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "sim/images/true_edges.h"
#include "sim/images/wire_paint.h"

namespace vernier::sim::internal {

/// Where the line fitted to an edge ends, against where the edge does.
struct EndError {
  EdgeEnd kind = EdgeEnd::border;
  bool found = false;    ///< a segment ends within 3 px of it along the edge
  double along_px = 0;   ///< positive: beyond the true end
  double across_px = 0;  ///< from the mean of the edge's own points
};

/// An edge in the eyes of a matcher.
struct MatchedEdge {
  bool asked = false;    ///< found in the left image and more than 5° from the rows
  bool matched = false;  ///< at least half of its points are
  double error_px = 0;   ///< median of found minus true disparity; signed

  /// By more than 3 px, as in characterise.
  bool is_wrong() const { return matched && (error_px > 3 || error_px < -3); }
};

/// What became of one edge that both eyes see.
struct EdgeSample {
  int pair = 0;
  int segment = 0;  ///< of the world
  EdgeAppearance appearance = EdgeAppearance::border;
  double contrast = 0;   ///< grey levels across it in the noise-free left image
  double angle_rad = 0;  ///< to the rows
  double depth_m = 0;
  /// Distance in the left image, at its middle, to the nearest other edge that runs along it
  /// (within 10°); infinite if there is none.
  double neighbour_px = std::numeric_limits<double>::infinity();
  double length_px = 0;  ///< in the left image, where both images have a source

  double left_found_px = 0, right_found_px = 0;  ///< length on a segment of that image
  double both_found_px = 0;                      ///< … of both
  int gaps = 0;                                  ///< stretches that are not on segments of both
  double longest_gap_px = 0;

  /// Median distance of its points from the true edge, along the same side of the edge in both
  /// eyes; NaN with fewer than 8 points. `brighter` is the sign of its brighter side in the left
  /// image.
  std::array<double, 2> shift_px{std::numeric_limits<double>::quiet_NaN(),
                                 std::numeric_limits<double>::quiet_NaN()};
  int brighter = 0;
  std::array<EndError, 2> ends;
  std::vector<MatchedEdge> matches;  ///< one per matcher
};

/// At least 98 % of its length is not on segments of both images.
inline bool is_unseen(const EdgeSample& edge) {
  constexpr double hardly = 0.02;
  return edge.both_found_px <= hardly * edge.length_px;
}

/// All of a pair, or of many.
struct ComparedEdges {
  std::vector<std::string> matchers;
  std::vector<EdgeSample> edges;
  /// Segments of the left images of at least 10 px that no edge of the world explains, by pair.
  std::vector<std::vector<double>> false_px;
  /// The length, by pair, of all segments of at least 10 px.
  std::vector<double> detected_px;

  int pairs() const { return static_cast<int>(false_px.size()); }
};

}  // namespace vernier::sim::internal
