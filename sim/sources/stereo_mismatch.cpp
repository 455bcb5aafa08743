// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <optional>

#include "calib/camera.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "sim/sources.h"
#include "sim/sources/source_draws.h"
#include "sim/sources/source_factories.h"
#include "sim/uncertainty_source.h"
#include "stereo/rectification.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

using namespace stereo;
using namespace vernier::internal;

namespace {

/// psi_s. The right line is displaced along the epipolar line.
class StereoMismatch : public UncertaintySource {
 public:
  explicit StereoMismatch(const SourceSettings& s)
      : share_(s.stereo_mismatch), reach_px_(s.stereo_mismatch_px) {}
  std::string_view name() const override { return "stereo_mismatch"; }

  void apply(const SensingContext& context, SensedView& view) const override {
    for (SensedEdge& edge : view.edges) {
      if (!edge.in_stereo) continue;
      RandomStream draws =
          draws_of(context, DrawSource::stereo_mismatch, edge.truth.feature * 2 + edge.piece);
      if (draws.uniform() >= share_) continue;
      const double slip = draws.uniform(-reach_px_, reach_px_);
      const ImageSegment right = image_of(context.rig, edge, 1);
      edge.offset_px[1][0] += along_epipolar(context, right.a_px, slip);
      edge.offset_px[1][1] += along_epipolar(context, right.b_px, slip);
    }
  }

 private:
  /// Displacement of a right pixel when its rectified column changes by `slip` pixels; none where
  /// it has no ray in front of the rectified camera.
  static Eigen::Vector2d along_epipolar(const SensingContext& context,
                                        const Eigen::Vector2d& pixel,
                                        double slip) {
    const Camera& right = context.rig.cameras[1];
    const Eigen::Matrix3d& R = context.rectification.R_rectified_right;
    const std::optional<Eigen::Vector3d> seen = try_unproject(right, pixel);
    if (!seen) return Eigen::Vector2d::Zero();
    Eigen::Vector3d ray = R * *seen;
    if (!(ray.z() > 0)) return Eigen::Vector2d::Zero();
    ray /= ray.z();
    ray.x() += slip / right.f_px();
    return project(right, R.transpose() * ray) - pixel;
  }

  double share_, reach_px_;
};

}  // namespace

SourcePointer make_stereo_mismatch(const SourceSettings& s) {
  return std::make_unique<StereoMismatch>(s);
}

}  // namespace vernier::sim::internal
