// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string_view>
#include <vector>

#include "calib/statistics/draw_sources.h"
#include "sim/sources.h"
#include "sim/sources/source_draws.h"
#include "sim/sources/source_factories.h"
#include "sim/uncertainty_source.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

/// Edges that a view misses whole, each view others.
class MissedEdges : public UncertaintySource {
 public:
  explicit MissedEdges(const SourceSettings& s) : share_(s.missed) {}
  std::string_view name() const override { return "missed"; }

  void apply(const SensingContext& context, SensedView& view) const override {
    std::erase_if(view.edges, [&](const SensedEdge& edge) {
      if (edge.truth.is_false()) return false;
      return draws_of(context, DrawSource::missed_edges, edge.truth.feature).uniform() < share_;
    });
  }

 private:
  double share_;
};

}  // namespace

SourcePointer make_missed_edges(const SourceSettings& s) {
  return std::make_unique<MissedEdges>(s);
}

}  // namespace vernier::sim::internal
