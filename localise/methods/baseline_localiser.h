// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "localise/localiser.h"
#include "localise/pgh.h"
#include "localise/place.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

/// The method of Tina Memo 2017-001 as far as it is documented, implemented plainly. See
/// make_localiser.
class BaselineLocaliser : public Localiser {
 public:
  explicit BaselineLocaliser(const TopologicalMap& map, const LocaliserOptions& options = {});

  LocalisationAnswer localise(const PlaceView& query) const override;

 private:
  const TopologicalMap& map_;
  PghOptions options_;
  std::vector<Pgh> histograms_;  // of the nodes' image lines; square roots as in Pgh
};

}  // namespace vernier::localise::internal
