// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <numbers>

#include "sim/sources.h"
#include "sim/sources/source_factories.h"
#include "sim/uncertainty_source.h"
#include "stereo/rectification.h"

namespace vernier::sim::internal {

using namespace stereo;

namespace {

/// The ±5° rule: stereo cannot localise edges along their epipolar line. One eye still sees them.
class EpipolarRejection : public UncertaintySource {
 public:
  explicit EpipolarRejection(const SourceSettings& s)
      : min_rad_(s.epipolar_reject_deg * std::numbers::pi / 180) {}
  std::string_view name() const override { return "epipolar_reject_deg"; }

  void apply(const SensingContext& context, SensedView& view) const override {
    for (SensedEdge& edge : view.edges) {
      edge.in_stereo =
          edge.in_stereo && epipolar_angle_rad(context.rig, context.rectification,
                                               image_of(context.rig, edge, 0)) >= min_rad_;
    }
  }

 private:
  double min_rad_;
};

}  // namespace

SourcePointer make_epipolar_rejection(const SourceSettings& s) {
  return std::make_unique<EpipolarRejection>(s);
}

}  // namespace vernier::sim::internal
