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

/// A place on the map: where it was recorded and what was seen from there.
struct MapNode {
  Pose2D pose;
  PlaceView view;
};

/// Views recorded along a path, with the histograms of their lines.
struct TopologicalMap {
  std::vector<MapNode> nodes;
  PghOptions options;           ///< queries must use the same
  std::vector<Pgh> histograms;  ///< one a node
};

/// Computes every node's spatial histograms.
TopologicalMap make_map(std::vector<MapNode> nodes, const PghOptions& options = {});

enum class LocalisationStatus {
  answered,
  too_few_lines,  ///< not enough in view to say anything
  tie,            ///< two places more than 1 m apart are equally good
  no_match,       ///< no place of the map agrees at all
};

std::string_view name(LocalisationStatus status);

struct LocalisationAnswer {
  LocalisationStatus status = LocalisationStatus::too_few_lines;
  int node = -1;  ///< the map's node, the memo's answer
  Pose2D pose;    ///< refined from it, metric
  double score = 0;
  double runner_up = 0;  ///< score of the best node more than 1 m away
};

/// Says where a view was taken. Implementations keep no state between queries.
class Localiser {
 public:
  virtual ~Localiser() = default;
  virtual LocalisationAnswer localise(const PlaceView& query) const = 0;
};

struct LocaliserOptions {
  int candidates = 12;  ///< best-ranked nodes that are verified by alignment
  int min_lines = 6;    ///< fewer lines in space: no answer
};

/// The localiser called `method` on a map, which must outlive it:
///
/// - `pgh`: spatial histograms rank the nodes by Bhattacharyya coefficients, rigid alignment of
///   the best verifies them and gives the metric pose;
/// - `pgh_baseline`: image-line histograms compared in a plain loop, and the memo's filter that
///   drops the lowest node until one is left. For comparison, not for use.
///
/// Throws Error for another name, listing these.
std::unique_ptr<Localiser> make_localiser(std::string_view method,
                                          const TopologicalMap& map,
                                          const LocaliserOptions& options = {});

std::vector<std::string> localiser_names();

}  // namespace vernier::localise
