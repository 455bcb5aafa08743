// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sim/image_comparison/edge_sample.h"

namespace vernier::sim::internal {

/// Ends of one kind.
struct EndFigures {
  int ends = 0;
  double found = 0;          ///< share with an end of a segment within 3 px along the edge
  double across_px = 0;      ///< standard deviation, those beyond three robust ones left out
  double along_px = 0;       ///< the same, along
  double along_mean_px = 0;  ///< positive: segments reach beyond the true end
};

struct MatchFigures {
  int lines = 0, matched = 0, wrong = 0;
  double wrong_px = 0;  ///< median distance of the wrong ones
};

/// What became of a group of edges; shares of length unless said. NaN where there are none.
struct EdgeFigures {
  int edges = 0;
  double length_px = 0;
  double left_loss = 0;                   ///< not on a segment of the left image
  double pair_loss = 0;                   ///< not on segments of both images
  double kept_whole = 0, lost_whole = 0;  ///< shares of edges: at most 2 %, at least 98 % lost
  double gaps = 0;                        ///< mean number, of edges that lose a part
  double longest_gap = 0;                 ///< share of their lost length in the longest gap
  int shifted = 0;                        ///< edges with a shift in both eyes
  double common_px = 0;                   ///< psi_l common to both eyes: s with the same covariance
  double independent_px = 0;       ///< psi_l independent in each eye: s with the same difference
  double median_shift_px = 0;      ///< of |shift| in the left image
  double towards_brighter_px = 0;  ///< median, towards the brighter side
  EndFigures corners, occlusions;
  std::vector<MatchFigures> matchers;
};

using EdgeFilter = std::function<bool(const EdgeSample&)>;
EdgeFigures edge_figures(const ComparedEdges& compared, const EdgeFilter& of);

struct ComparisonGroup {
  std::string name;
  EdgeFigures figures;
};
struct ComparisonTable {
  std::string by;  ///< "contrast", in words for a heading
  std::vector<ComparisonGroup> groups;
};

/// Whether an edge is one that a detector should find: a step (a border or an outline) of at least
/// 20 grey levels, at least 40 px long, with no other edge along it within 6 px.
bool is_clear(const EdgeSample& edge);

/// Edges by how they are shown, whether they are clear, by contrast, angle to the rows, depth,
/// distance of the nearest edge, and length.
std::vector<ComparisonTable> comparison_tables(const ComparedEdges& compared);

/// Of edges unseen in one view: how often an edge of the same segment is unseen in another. NaN if
/// there are no two views of one.
double unseen_again(const ComparedEdges& compared);

/// Robust standard deviation: 1.4826 times the median distance from the median. 0 of none.
double robust_deviation(const std::vector<double>& values);

}  // namespace vernier::sim::internal
