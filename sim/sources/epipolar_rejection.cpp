// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <numbers>
#include <optional>

#include "sim/sources.h"
#include "sim/sources/source_factories.h"
#include "sim/uncertainty_source.h"
#include "stereo/rectification.h"

namespace vernier::sim::internal {

using namespace stereo;

namespace {

/// The ±5° rule: stereo cannot localise edges along their epipolar line. One eye still sees them.
/// Nor those with an end that another source has moved beyond the lens's field.
class EpipolarRejection : public UncertaintySource {
 public:
  explicit EpipolarRejection(const SourceSettings& s)
      : min_rad_(s.epipolar_reject_deg * std::numbers::pi / 180) {}
  std::string_view name() const override { return "epipolar_reject_deg"; }

  void apply(const SensingContext& context, SensedView& view) const override {
    for (SensedEdge& edge : view.edges) {
      if (!edge.in_stereo) continue;
      const std::optional<double> angle_rad =
          epipolar_angle_rad(context.rig, context.rectification, image_of(context.rig, edge, 0));
      edge.in_stereo = angle_rad && *angle_rad >= min_rad_;
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
