// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "localise/localiser.h"
#include "localise/odometry.h"
#include "localise/odometry/floor_step.h"
#include "localise/odometry/step_consensus.h"
#include "localise/place.h"
#include "localise/ranking/corner_index.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

/// Localisation on points: nodes ranked by words of descriptors, corners matched with those of the
/// best ones, a pose on the floor by consensus and least squares on pixels. See make_localiser and
/// docs/localisation.md.
class CornerLocaliser : public Localiser {
 public:
  static constexpr int most_candidates = 40;  ///< matching is slow

  /// Throws Error for a node whose corners are not finite, have no rig of two cameras or
  /// descriptors of another length than others.
  CornerLocaliser(const TopologicalMap& map, const LocaliserOptions& options);

  /// Throws Error for corners as above, in the query.
  LocalisationAnswer localise(const PlaceView& query) const override;

 private:
  struct Seen;
  struct Candidate;

  std::optional<Candidate> candidate(int node, const Seen& seen) const;
  LocalisationAnswer answer(std::vector<Candidate> candidates, const Seen& seen) const;

  const TopologicalMap& map_;
  LocaliserOptions options_;
  CornerIndex index_;
};

}  // namespace vernier::localise::internal
