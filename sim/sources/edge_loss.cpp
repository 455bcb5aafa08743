// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "calib/rig.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "sim/sources.h"
#include "sim/sources/source_draws.h"
#include "sim/sources/source_factories.h"
#include "sim/uncertainty_source.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

/// psi_e. One gap of a fixed fraction of the length at a uniform position; it may trim an end.
class EdgeLoss : public UncertaintySource {
 public:
  EdgeLoss(const SourceSettings& s, double min_length_px)
      : share_(s.edge_loss), min_length_px_(min_length_px) {}
  std::string_view name() const override { return "edge_loss"; }

  void apply(const SensingContext& context, SensedView& view) const override {
    std::vector<SensedEdge> left_over;
    for (const SensedEdge& edge : view.edges) {
      RandomStream draws = draws_of(context, DrawSource::edge_loss, edge.truth.feature);
      const double start = std::clamp(draws.uniform(-share_, 1), 0.0, 1 - share_);
      add_piece(context.rig, edge, 0, start, 0, left_over);
      add_piece(context.rig, edge, start + share_, 1, 1, left_over);
    }
    view.edges = std::move(left_over);
  }

 private:
  /// The part between two fractions of the left image line, if long enough to be detected.
  void add_piece(const Rig& rig,
                 const SensedEdge& edge,
                 double from,
                 double to,
                 std::uint32_t piece,
                 std::vector<SensedEdge>& pieces) const {
    if (!(to > from)) return;
    SensedEdge part = edge;
    const double wa = 1 / edge.truth.a_m.z(), wb = 1 / edge.truth.b_m.z();
    const auto at = [&](double fraction) -> Eigen::Vector3d {  // perspective: linear in 1/z
      const double t = fraction * wb / ((1 - fraction) * wa + fraction * wb);
      return edge.truth.a_m + t * (edge.truth.b_m - edge.truth.a_m);
    };
    part.truth.a_m = at(from);
    part.truth.b_m = at(to);
    part.piece = piece;
    if (image_of(rig, part, 0).length_px() >= min_length_px_) pieces.push_back(part);
  }

  double share_, min_length_px_;
};

}  // namespace

SourcePointer make_edge_loss(const SourceSettings& s, double min_length_px) {
  return std::make_unique<EdgeLoss>(s, min_length_px);
}

}  // namespace vernier::sim::internal
