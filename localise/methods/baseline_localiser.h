// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "localise/localiser.h"
#include "localise/pgh.h"
#include "localise/place.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

/// The method of Tina Memo 2017-001 as far as it is documented: image-line histograms, every line
/// of the query compared with every line of every node by its Bhattacharyya coefficient, and a
/// filter that drops the lowest node until one is left. The coefficient is computed as it is
/// defined, Σ √(p q) in a plain loop. The reference that faster methods are measured against. See
/// make_localiser.
class BaselineLocaliser : public Localiser {
 public:
  explicit BaselineLocaliser(const TopologicalMap& map, const LocaliserOptions& options = {});

  LocalisationAnswer localise(const PlaceView& query) const override;

 private:
  const TopologicalMap& map_;
  PghOptions options_;
  std::vector<HistogramRows> histograms_;  // of the nodes' image lines, each row of sum 1
};

/// The same method, and the same answers up to rounding: the roots are taken once, when the map is
/// made, so that a coefficient is a dot product, computed in SIMD (best_matches).
class VectorisedBaselineLocaliser : public Localiser {
 public:
  explicit VectorisedBaselineLocaliser(const TopologicalMap& map,
                                       const LocaliserOptions& options = {});

  LocalisationAnswer localise(const PlaceView& query) const override;

 private:
  const TopologicalMap& map_;
  PghOptions options_;
  std::vector<Pgh> histograms_;  // of the nodes' image lines
};

}  // namespace vernier::localise::internal
