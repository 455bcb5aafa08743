// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "sim/noise_free_view.h"
#include "sim/sources.h"
#include "sim/sources/false_features.h"
#include "sim/sources/source_draws.h"
#include "sim/sources/source_factories.h"
#include "sim/uncertainty_source.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

/// False edges, as of texture and shadows: marks on a surface at the depth of an edge in view, seen
/// by both eyes, in this look only.
class Clutter : public UncertaintySource {
 public:
  Clutter(const SourceSettings& s, double min_length_px)
      : share_(s.clutter),
        shortest_px_(std::max(10.0, min_length_px)),
        longest_px_(10 * shortest_px_) {}
  std::string_view name() const override { return "clutter"; }

  void apply(const SensingContext& context, SensedView& view) const override {
    const std::size_t visible = view.edges.size();
    for (const SensedEdge& edge : view.edges) {
      if (edge.truth.feature < first_false_feature) continue;
      throw Error("feature " + std::to_string(edge.truth.feature),
                  "is one of those kept for false edges", "use a smaller world, or clutter 0");
    }
    const double wanted = share_ * static_cast<double>(visible);
    const auto count = static_cast<std::uint32_t>(
        std::min(std::floor(wanted + draws_of(context, DrawSource::clutter, 0).uniform()),
                 static_cast<double>(most_false_features)));
    for (std::uint32_t i = 0; i < count; ++i) {
      RandomStream draws = draws_of(context, DrawSource::clutter, i + 1);
      const auto of = std::min(
          static_cast<std::size_t>(draws.uniform() * static_cast<double>(visible)), visible - 1);
      const VisibleEdge& near = view.edges[of].truth;
      SensedEdge mark;
      if (!place(context.rig, 0.5 * (near.a_m.z() + near.b_m.z()), draws, mark.truth)) continue;
      mark.truth.segment = no_segment;
      mark.truth.feature = first_false_feature + i;
      mark.truth.object_centre_m.setZero();
      view.edges.push_back(mark);
    }
  }

 private:
  /// Anywhere in the left image, in any direction, at one depth; drawn again unless both cameras
  /// see all of it. False if none of the draws is seen.
  bool place(const Rig& rig, double depth_m, RandomStream& draws, VisibleEdge& mark) const {
    constexpr int most_draws = 100;
    const Camera& left = rig.cameras[0];
    for (int i = 0; i < most_draws; ++i) {
      const double y = draws.uniform(0, left.size_px[1]) - 0.5;
      const double x = draws.uniform(0, left.size_px[0]) - 0.5;
      const Eigen::Vector2d middle(x, y);
      const double way = draws.uniform(0, std::numbers::pi);
      const double half = draws.uniform(shortest_px_, longest_px_) / 2;
      const Eigen::Vector2d along = half * Eigen::Vector2d(std::cos(way), std::sin(way));
      if (!in_image(left, middle - along) || !in_image(left, middle + along)) continue;
      const auto a = try_unproject(left, middle - along), b = try_unproject(left, middle + along);
      if (!a || !b) continue;
      mark.a_m = depth_m / a->z() * *a;
      mark.b_m = depth_m / b->z() * *b;
      if (is_seen(rig, 1, mark.a_m) && is_seen(rig, 1, mark.b_m)) return true;
    }
    return false;
  }

  static bool is_seen(const Rig& rig, int eye, const Eigen::Vector3d& at_m) {
    const Eigen::Vector3d x = rig.T_camera_first[eye] * at_m;
    return x.z() > 0 && in_image(rig.cameras[eye], project(rig.cameras[eye], x));
  }

  double share_, shortest_px_, longest_px_;
};

}  // namespace

SourcePointer make_clutter(const SourceSettings& s, double min_length_px) {
  return std::make_unique<Clutter>(s, min_length_px);
}

}  // namespace vernier::sim::internal
