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

/// psi_g.
class EndpointError : public UncertaintySource {
 public:
  explicit EndpointError(const SourceSettings& s) : sigma_px_(s.endpoint_sigma_px) {}
  std::string_view name() const override { return "endpoint_sigma_px"; }

  void apply(const SensingContext& context, SensedView& view) const override {
    for (SensedEdge& edge : view.edges) {
      for (std::uint32_t eye = 0; eye < 2; ++eye) {
        RandomStream draws =
            draws_of(context, DrawSource::endpoint_noise, edge.truth.feature * 2 + edge.piece, eye);
        for (Eigen::Vector2d& offset : edge.offset_px[eye]) {
          offset.x() += sigma_px_ * draws.normal();
          offset.y() += sigma_px_ * draws.normal();
        }
      }
    }
  }

 private:
  double sigma_px_;
};

}  // namespace

SourcePointer make_endpoint_error(const SourceSettings& s) {
  return std::make_unique<EndpointError>(s);
}

}  // namespace vernier::sim::internal
