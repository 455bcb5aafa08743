// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <memory>

#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "sim/sources.h"
#include "sim/sources/source_draws.h"
#include "sim/sources/source_factories.h"
#include "sim/uncertainty_source.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

/// psi_g, of corners.
class CornerErrorSource : public UncertaintySource {
 public:
  explicit CornerErrorSource(const SourceSettings& s) : sigma_px_(s.corner_sigma_px) {}
  std::string_view name() const override { return "corner_sigma_px"; }

  void apply(const SensingContext& context, SensedView& view) const override {
    for (SensedCorner& corner : view.corners) {
      for (std::uint32_t eye = 0; eye < 2; ++eye) {
        RandomStream draws = draws_of(context, DrawSource::corner_noise, corner.truth.feature, eye);
        corner.pixel_px[eye] += sigma_px_ * Eigen::Vector2d(draws.normals(2));
      }
    }
  }

 private:
  double sigma_px_;
};

}  // namespace

SourcePointer make_corner_error(const SourceSettings& s) {
  return std::make_unique<CornerErrorSource>(s);
}

}  // namespace vernier::sim::internal
