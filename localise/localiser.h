// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "localise/pgh.h"
#include "localise/place.h"

namespace vernier::localise {

/// A map node: the pose where it was recorded and the view from there.
struct MapNode {
  Pose2D pose;
  PlaceView view;
};

/// Views recorded along a route, with the histograms of their lines.
struct TopologicalMap {
  std::vector<MapNode> nodes;
  PghOptions options;           ///< queries must use the same options
  std::vector<Pgh> histograms;  ///< one per node
};

/// Computes the spatial histograms of every node.
TopologicalMap make_map(std::vector<MapNode> nodes, const PghOptions& options = {});

enum class LocalisationStatus {
  answered,
  too_few_lines,  ///< fewer than min_lines lines
  tie,            ///< two positions more than 1 m apart have the same best score
  no_match,       ///< no node of the map matches
};

std::string_view name(LocalisationStatus status);

struct LocalisationAnswer {
  LocalisationStatus status = LocalisationStatus::too_few_lines;
  int node = -1;  ///< index of the map node, the memo's answer
  Pose2D pose;    ///< refined metric pose
  double score = 0;
  double runner_up = 0;  ///< score of the best node more than 1 m away
};

/// Estimates where a view was taken. Implementations keep no state between queries.
class Localiser {
 public:
  virtual ~Localiser() = default;
  virtual LocalisationAnswer localise(const PlaceView& query) const = 0;
};

struct LocaliserOptions {
  int candidates = 12;  ///< number of best-ranked nodes verified by alignment
  int min_lines = 6;    ///< minimum number of lines in space for an answer
};

/// Creates the localiser named `method` on a map, which must outlive it:
///
///  - `pgh`: spatial histograms rank the nodes by Bhattacharyya coefficients; rigid alignment of
///    the best ones verifies them and gives the metric pose;
///  - `pgh_baseline`: image-line histograms compared in a plain loop, and the memo's filter that
///    eliminates the lowest node until one is left. For comparison only.
///
/// Throws Error for any other name, listing these.
std::unique_ptr<Localiser> make_localiser(std::string_view method,
                                          const TopologicalMap& map,
                                          const LocaliserOptions& options = {});

std::vector<std::string> localiser_names();

}  // namespace vernier::localise
