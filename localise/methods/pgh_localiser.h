// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "localise/localiser.h"
#include "localise/place.h"
#include "localise/ranking/histogram_ranker.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

/// Ranks nodes by histograms, verifies and refines by rigid alignment. See make_localiser.
class PghLocaliser : public Localiser {
 public:
  static constexpr int most_candidates = 12;  ///< alignment is slow

  PghLocaliser(const TopologicalMap& map, const LocaliserOptions& options)
      : map_(map), options_(options), ranker_(map, options.histograms) {}

  LocalisationAnswer localise(const PlaceView& query) const override;

 private:
  const TopologicalMap& map_;
  LocaliserOptions options_;
  HistogramRanker ranker_;
};

}  // namespace vernier::localise::internal
