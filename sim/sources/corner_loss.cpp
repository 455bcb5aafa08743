// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <memory>
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

/// psi_cd. The pair is lost, not a single corner of it.
class CornerLoss : public UncertaintySource {
 public:
  explicit CornerLoss(const SourceSettings& s) : share_(s.corner_loss) {}
  std::string_view name() const override { return "corner_loss"; }

  void apply(const SensingContext& context, SensedView& view) const override {
    std::erase_if(view.corners, [&](const SensedCorner& corner) {
      return draws_of(context, DrawSource::corner_loss, corner.truth.feature).uniform() < share_;
    });
  }

 private:
  double share_;
};

}  // namespace

SourcePointer make_corner_loss(const SourceSettings& s) { return std::make_unique<CornerLoss>(s); }

}  // namespace vernier::sim::internal
