// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string_view>
#include <vector>

#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "sim/sources.h"
#include "sim/sources/source_draws.h"
#include "sim/sources/source_factories.h"
#include "sim/uncertainty_source.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

/// Edges that a view misses whole. Of what it misses, a part is missed by all views of the place:
/// an edge has a grid of places of its own, squares of one side in any direction, and takes the
/// draw of the place with probability sqrt(missed_alike), else that of the view. Two views of one
/// place then have the correlation missed_alike, and the share is the same everywhere.
class MissedEdges : public UncertaintySource {
 public:
  explicit MissedEdges(const SourceSettings& s)
      : share_(s.missed), by_place_(std::sqrt(s.missed_alike)), side_m_(s.missed_alike_m) {}
  std::string_view name() const override { return "missed"; }

  void apply(const SensingContext& context, SensedView& view) const override {
    std::erase_if(view.edges, [&](const SensedEdge& edge) {
      if (edge.truth.is_false()) return false;
      RandomStream draws = draws_of(context, DrawSource::missed_edges, edge.truth.feature);
      const double of_view = draws.uniform();
      if (by_place_ == 0) return of_view < share_;
      const bool is_of_place = draws.uniform() < by_place_;
      return (is_of_place ? draw_of_place(context, edge.truth.segment) : of_view) < share_;
    });
  }

 private:
  /// The same for all looks from one place, in all trials and in maps.
  double draw_of_place(const SensingContext& context, int segment) const {
    RandomCounter place{.seed = context.seed,
                        .feature = static_cast<std::uint32_t>(segment),
                        .source = static_cast<std::uint32_t>(DrawSource::missed_edges),
                        .eye = 2};
    RandomStream grid(place);
    const double turn_rad = grid.uniform(0, std::numbers::pi / 2);
    const double offset_y = grid.uniform(), offset_x = grid.uniform();
    const Eigen::Vector2d offset(offset_x, offset_y);
    const Eigen::Vector2d at = Eigen::Rotation2Dd(turn_rad) * context.at_m / side_m_ + offset;
    place.trial = index(at.x(), 32);
    place.frame = index(at.y(), 22);  // its bits in a counter
    place.eye = 3;
    return RandomStream(place).uniform();
  }

  /// Of a cell, in so many bits; from the left to the right of 0 too.
  static std::uint32_t index(double cell, int bits) {
    const auto number = static_cast<std::int64_t>(std::floor(cell));
    return static_cast<std::uint32_t>(number & ((std::int64_t{1} << bits) - 1));
  }

  double share_, by_place_, side_m_;
};

}  // namespace

SourcePointer make_missed_edges(const SourceSettings& s) {
  return std::make_unique<MissedEdges>(s);
}

}  // namespace vernier::sim::internal
