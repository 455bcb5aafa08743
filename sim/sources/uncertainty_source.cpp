// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/uncertainty_source.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>

#include "calib/camera.h"
#include "calib/rig.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "sim/noise_free_view.h"
#include "sim/sources.h"
#include "stereo/rectification.h"
#include "stereo/segment.h"

namespace vernier::sim {

using namespace stereo;
using namespace vernier::internal;

ImageSegment image_of(const Rig& rig, const SensedEdge& edge, int eye) {
  const auto pixel = [&](const Eigen::Vector3d& x, int end) -> Eigen::Vector2d {
    return project(rig.cameras[eye], rig.T_camera_first[eye] * x) + edge.offset_px[eye][end];
  };
  return {pixel(edge.truth.a_m, 0), pixel(edge.truth.b_m, 1)};
}

namespace {

RandomStream draws_of(const SensingContext& context,
                      DrawSource source,
                      std::uint32_t feature,
                      std::uint32_t eye = 0) {
  return RandomStream({.seed = context.seed,
                       .trial = context.trial,
                       .feature = feature,
                       .source = static_cast<std::uint32_t>(source),
                       .eye = eye,
                       .frame = context.frame});
}

/// psi_l. Illumination moves the boundary of a surface inwards or outwards: one sign per surface
/// (object), one magnitude per edge, the same for all views of a trial.
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
  /// Along the left normal of the image line, pixels; `side` is +1 if that points outward.
  double draw_shift(const SensingContext& any_frame,
                    const SensedEdge& edge,
                    int eye,
                    double side) const {
    const bool independent = mode_ == ShiftMode::independent;
    const auto stream = static_cast<std::uint32_t>(independent ? eye + 1 : 0);
    RandomStream of_edge = draws_of(any_frame, DrawSource::lateral_shift,
                                    static_cast<std::uint32_t>(edge.truth.segment), stream);
    const double size = size_ * of_edge.uniform(0.5, 1.5);
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

/// psi_e. One gap of a fixed fraction of the length at a uniform position; it may trim an end.
class EdgeLoss : public UncertaintySource {
 public:
  EdgeLoss(const SourceSettings& s, double min_length_px)
      : share_(s.edge_loss), min_length_px_(min_length_px) {}
  std::string_view name() const override { return "edge_loss"; }

  void apply(const SensingContext& context, SensedView& view) const override {
    std::vector<SensedEdge> left_over;
    for (const SensedEdge& edge : view.edges) {
      RandomStream draws = draws_of(context, DrawSource::edge_loss, edge.truth.feature);
      const double start = std::clamp(draws.uniform(-share_, 1), 0.0, 1 - share_);
      add_piece(context.rig, edge, 0, start, 0, left_over);
      add_piece(context.rig, edge, start + share_, 1, 1, left_over);
    }
    view.edges = std::move(left_over);
  }

 private:
  /// The part between two fractions of the left image line, if long enough to be detected.
  void add_piece(const Rig& rig,
                 const SensedEdge& edge,
                 double from,
                 double to,
                 std::uint32_t piece,
                 std::vector<SensedEdge>& pieces) const {
    if (!(to > from)) return;
    SensedEdge part = edge;
    const double wa = 1 / edge.truth.a_m.z(), wb = 1 / edge.truth.b_m.z();
    const auto at = [&](double fraction) -> Eigen::Vector3d {  // perspective: linear in 1/z
      const double t = fraction * wb / ((1 - fraction) * wa + fraction * wb);
      return edge.truth.a_m + t * (edge.truth.b_m - edge.truth.a_m);
    };
    part.truth.a_m = at(from);
    part.truth.b_m = at(to);
    part.piece = piece;
    if (image_of(rig, part, 0).length_px() >= min_length_px_) pieces.push_back(part);
  }

  double share_, min_length_px_;
};

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
  /// Displacement of a right pixel when its rectified column changes by `slip` pixels.
  static Eigen::Vector2d along_epipolar(const SensingContext& context,
                                        const Eigen::Vector2d& pixel,
                                        double slip) {
    const Camera& right = context.rig.cameras[1];
    const Eigen::Matrix3d& R = context.rectification.R_rectified_right;
    Eigen::Vector3d ray = R * unproject(right, pixel);
    ray /= ray.z();
    ray.x() += slip / right.f_px();
    return project(right, R.transpose() * ray) - pixel;
  }

  double share_, reach_px_;
};

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

/// psi_g, of corners.
class CornerError : public UncertaintySource {
 public:
  explicit CornerError(const SourceSettings& s) : sigma_px_(s.corner_sigma_px) {}
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

std::vector<std::unique_ptr<UncertaintySource>> standard_sources(const SourceSettings& s,
                                                                 double min_length_px) {
  std::vector<std::unique_ptr<UncertaintySource>> sources;
  if (s.lateral_shift_px > 0) sources.push_back(std::make_unique<LateralShift>(s));
  if (s.edge_loss > 0) sources.push_back(std::make_unique<EdgeLoss>(s, min_length_px));
  if (s.endpoint_sigma_px > 0) sources.push_back(std::make_unique<EndpointError>(s));
  if (s.epipolar_reject_deg > 0) sources.push_back(std::make_unique<EpipolarRejection>(s));
  if (s.stereo_mismatch > 0) sources.push_back(std::make_unique<StereoMismatch>(s));
  if (s.corner_loss > 0) sources.push_back(std::make_unique<CornerLoss>(s));
  if (s.corner_sigma_px > 0) sources.push_back(std::make_unique<CornerError>(s));
  if (s.corner_mismatch > 0) sources.push_back(std::make_unique<CornerMismatch>(s));
  return sources;
}

}  // namespace vernier::sim
