// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>

#include "calib/rig.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "sim/noise_free_view.h"
#include "sim/sources.h"
#include "sim/sources/common_shift.h"
#include "sim/sources/source_draws.h"
#include "sim/sources/source_factories.h"
#include "sim/uncertainty_source.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

using namespace stereo;
using namespace vernier::internal;

namespace {

/// psi_l. Illumination moves the boundary of a surface inwards or outwards: one sign per surface
/// (object), one magnitude per edge, the same for all views of a trial. A common shift is that
/// of an edge displaced in space, by pixels of the left image (sim/sources/common_shift.h).
class LateralShift : public UncertaintySource {
 public:
  explicit LateralShift(const SourceSettings& s)
      : size_(s.lateral_shift_px), mode_(s.lateral_shift_mode) {}
  std::string_view name() const override { return "lateral_shift_px"; }

  void apply(const SensingContext& context, SensedView& view) const override {
    SensingContext any_frame = context;
    any_frame.frame = 0;
    for (SensedEdge& edge : view.edges) {
      const double side = outward(edge.truth);
      for (int eye = 0; eye < 2; ++eye) {
        displace(context.rig, edge, eye, draw_shift(any_frame, edge, eye, side));
      }
    }
  }

 private:
  /// The edge of the world, so that its parts share a shift; a false edge is one by itself.
  static std::uint32_t identity(const VisibleEdge& edge) {
    return edge.is_false() ? edge.feature : static_cast<std::uint32_t>(edge.segment);
  }

  /// Along the left normal of the image line, pixels; `side` is +1 if that points outward.
  double draw_shift(const SensingContext& any_frame,
                    const SensedEdge& edge,
                    int eye,
                    double side) const {
    const bool independent = mode_ == ShiftMode::independent;
    const auto stream = static_cast<std::uint32_t>(independent ? eye + 1 : 0);
    RandomStream of_edge =
        draws_of(any_frame, DrawSource::lateral_shift, identity(edge.truth), stream);
    const double ratio = independent || eye == 0
                             ? 1
                             : right_by_left_shift(any_frame.rig, edge.truth.a_m, edge.truth.b_m);
    const double size = size_ * ratio * of_edge.uniform(0.5, 1.5);
    if (independent || edge.truth.object == 0) return of_edge.uniform() < 0.5 ? -size : size;
    // Index 3 in the eye's position of the key marks draws of surfaces.
    RandomStream of_surface = draws_of(any_frame, DrawSource::lateral_shift,
                                       static_cast<std::uint32_t>(edge.truth.object), 3);
    return (of_surface.uniform() < 0.5 ? -size : size) * side;
  }

  /// +1 if the left normal of the image line points away from the object's centre: determined in
  /// the edge's plane through the eye, so equal for all viewpoints on one side of it.
  static double outward(const VisibleEdge& edge) {
    const Eigen::Vector3d n = edge.a_m.cross(edge.b_m);
    const double side = n.dot(edge.object_centre_m);
    // An edge through the centre has no outside; rounding must not select one.
    return side > 1e-9 * n.norm() * edge.object_centre_m.norm() ? -1 : 1;
  }

  static void displace(const Rig& rig, SensedEdge& edge, int eye, double shift) {
    const ImageSegment line = image_of(rig, edge, eye);
    const Eigen::Vector2d d = (line.b_px - line.a_px).normalized();
    const Eigen::Vector2d normal(-d.y(), d.x());
    for (Eigen::Vector2d& offset : edge.offset_px[eye]) offset += shift * normal;
  }

  double size_;
  ShiftMode mode_;
};

}  // namespace

SourcePointer make_lateral_shift(const SourceSettings& s) {
  return std::make_unique<LateralShift>(s);
}

}  // namespace vernier::sim::internal
