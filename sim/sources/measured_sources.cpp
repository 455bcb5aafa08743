// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/sources/measured_sources.h"

#include "calib/error.h"
#include "sim/sources/clustered_samples.h"
#include "sim/sources/measured_figures.h"
#include "stereo/evaluation/pair_samples.h"

namespace vernier::sim::internal {

using namespace stereo::internal;

MeasuredSources measure_sources(const std::vector<PairSamples>& pairs,
                                const MeasuringOptions& options) {
  if (pairs.empty()) {
    throw Error("measured sources", "no pairs", "give at least one pair");
  }
  constexpr int parts = 16;
  MeasuredSources sources;
  for (const PairSamples& pair : pairs) sources.pairs.push_back(pair.name);
  const int count = static_cast<int>(pairs.size());
  sources.by_pair = count >= options.pairs_for_clusters;
  sources.clusters = sources.by_pair ? count : parts * count;
  const ClusterOf cluster{sources.by_pair};
  sources.edge_loss = measured_edge_loss(pairs, cluster, options);
  sources.lateral_shift = measured_lateral_shift(pairs, cluster, options);
  sources.endpoints = measured_endpoints(pairs, cluster, options);
  sources.corners = measured_corners(pairs, cluster, options);
  sources.stereo_mismatch = measured_stereo_mismatch(pairs, cluster, options);
  return sources;
}

}  // namespace vernier::sim::internal
