// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <memory>
#include <numbers>

#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "sim/sources.h"
#include "sim/sources/source_draws.h"
#include "sim/sources/source_factories.h"
#include "sim/uncertainty_source.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

/// psi_cm. The right corner is replaced by a point in a disc.
class CornerMismatch : public UncertaintySource {
 public:
  explicit CornerMismatch(const SourceSettings& s)
      : share_(s.corner_mismatch), radius_px_(s.corner_mismatch_px) {}
  std::string_view name() const override { return "corner_mismatch"; }

  void apply(const SensingContext& context, SensedView& view) const override {
    for (SensedCorner& corner : view.corners) {
      RandomStream draws = draws_of(context, DrawSource::corner_mismatch, corner.truth.feature);
      if (draws.uniform() >= share_) continue;
      const double radius = radius_px_ * std::sqrt(draws.uniform());
      const double angle = draws.uniform(0, 2 * std::numbers::pi);
      corner.pixel_px[1] += radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      corner.mismatched = true;
    }
  }

 private:
  double share_, radius_px_;
};

}  // namespace

SourcePointer make_corner_mismatch(const SourceSettings& s) {
  return std::make_unique<CornerMismatch>(s);
}

}  // namespace vernier::sim::internal
