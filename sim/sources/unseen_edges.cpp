// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "sim/sources.h"
#include "sim/sources/source_factories.h"
#include "sim/uncertainty_source.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

/// Segments of the world that no image shows, for want of contrast: the same in all looks and in
/// the map.
class UnseenEdges : public UncertaintySource {
 public:
  explicit UnseenEdges(const SourceSettings& s) : share_(s.unseen) {}
  std::string_view name() const override { return "unseen"; }

  void apply(const SensingContext& context, SensedView& view) const override {
    std::erase_if(view.edges, [&](const SensedEdge& edge) {
      if (edge.truth.is_false()) return false;
      RandomStream draws({.seed = context.seed,
                          .feature = static_cast<std::uint32_t>(edge.truth.segment),
                          .source = static_cast<std::uint32_t>(DrawSource::unseen_edges)});
      return draws.uniform() < share_;
    });
  }

 private:
  double share_;
};

}  // namespace

SourcePointer make_unseen_edges(const SourceSettings& s) {
  return std::make_unique<UnseenEdges>(s);
}

}  // namespace vernier::sim::internal
