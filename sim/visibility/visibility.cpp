// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/visibility.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "sim/visibility/convex_pieces.h"
#include "sim/visibility/shadow.h"
#include "sim/visibility/shadow_grid.h"
#include "sim/visibility/view_frustum.h"
#include "sim/world.h"

namespace vernier::sim {

using namespace internal;

namespace {

void check(const Pose& T_camera_world, const VisibilityOptions& options) {
  if (!(options.surface_gap_m >= 0)) {
    throw Error("visibility", "surface_gap_m is negative or NaN", "use 0 or more");
  }
  if (!T_camera_world.R.allFinite() || !T_camera_world.t.allFinite()) {
    throw Error("visibility", "the camera's pose is not finite", "use finite values");
  }
}

/// The gap, at least large enough that rounding cannot hide a surface's own edges.
double gap_m(const VisibilityOptions& options) {
  return std::max(options.surface_gap_m, edge_on_m);
}

/// Intersection of both, ascending.
void intersect(const std::vector<Stretch>& one,
               const std::vector<Stretch>& other,
               std::vector<Stretch>& both) {
  both.clear();
  for (const Stretch& u : one) {
    for (const Stretch& v : other) {
      const Stretch s{std::max(u.t0, v.t0), std::min(u.t1, v.t1)};
      if (s.t1 - s.t0 > min_stretch) both.push_back(s);
    }
  }
}

/// Buffers reused for all segments of a view.
struct Scratch {
  ShadowGrid grid;
  std::vector<OccludedInterval> hidden;
  std::vector<Stretch> unhidden, inside, seen;
  std::vector<ShadowSide> sides;
};
thread_local Scratch scratch;

/// Visibility of a point x from an eye, with respect to all surfaces.
PointInShadow classify(const ConvexSurfaces& surfaces,
                       const Eigen::Vector3d& eye,
                       const Eigen::Vector3d& x,
                       double gap,
                       std::vector<Eigen::Vector3d>* touched = nullptr) {
  PointInShadow result = PointInShadow::outside;
  for (const ConvexSurface& piece : surfaces.pieces) {
    double distance = piece.distance_m - piece.normal.dot(eye);
    double beyond = piece.normal.dot(x) - distance;
    const bool flip = distance < 0;
    if (flip) {
      distance = -distance;
      beyond = -beyond;
    }
    if (distance <= edge_on_m || beyond <= gap) continue;
    const double reach = piece.radius_m + 1e-7;  // larger than any tolerance
    if ((piece.centre_m - eye).cross(x).squaredNorm() > reach * reach * x.squaredNorm()) continue;
    scratch.sides.clear();
    const Eigen::Vector3d* p = surfaces.vertices_m.data() + piece.first_vertex;
    for (int i = 0; i < piece.vertex_count; ++i) {
      const Eigen::Vector3d from = p[i] - eye;
      const Eigen::Vector3d to = p[i + 1 < piece.vertex_count ? i + 1 : 0] - eye;
      scratch.sides.push_back(flip ? shadow_side(to, from) : shadow_side(from, to));
    }
    const Shadow shadow{flip ? -piece.normal : piece.normal, distance, scratch.sides};
    const PointInShadow where = point_in_shadow(shadow, x, gap, touched);
    if (where == PointInShadow::inside) return where;
    if (where == PointInShadow::on_border) result = where;
  }
  return result;
}

}  // namespace

struct Visibility::Index {
  const World& world;
  ConvexSurfaces surfaces;
};

Visibility::Visibility(const World& world) : index_(new Index{world, convex_surfaces(world)}) {}
Visibility::~Visibility() = default;
Visibility::Visibility(Visibility&&) noexcept = default;

const World& Visibility::world() const { return index_->world; }

std::vector<VisibleInterval> Visibility::visible_intervals(const Camera& camera,
                                                           const Pose& T_camera_world,
                                                           const VisibilityOptions& options) const {
  check(T_camera_world, options);
  const ViewFrustum frustum(camera, options.near_m, options.far_m);
  Scratch& s = scratch;
  s.grid.build(index_->surfaces, T_camera_world, frustum, gap_m(options));
  std::vector<VisibleInterval> runs;
  const std::vector<WorldSegment>& segments = index_->world.segments;
  for (int i = 0; i < static_cast<int>(segments.size()); ++i) {
    const Eigen::Vector3d a = T_camera_world * segments[i].a_m;
    const Eigen::Vector3d b = T_camera_world * segments[i].b_m;
    Stretch open;
    if (!frustum.clip(a, b, open) || !s.grid.hide(a, b, open, s.hidden)) continue;
    frustum.in_image(a, b, open, s.inside);
    subtract_intervals(open, s.hidden, s.unhidden);
    intersect(s.unhidden, s.inside, s.seen);
    const auto pixel = [&](double t) { return project(camera, a + t * (b - a)); };
    for (int run = 0; run < static_cast<int>(s.seen.size()); ++run) {
      const auto [t0, t1] = s.seen[run];
      if ((pixel(t1) - pixel(t0)).norm() < options.min_length_px) continue;
      runs.push_back({i, run, t0, t1});
    }
  }
  return runs;
}

std::vector<int> Visibility::visible_corners(const Camera& camera,
                                             const Pose& T_camera_world,
                                             const VisibilityOptions& options) const {
  check(T_camera_world, options);
  const ViewFrustum frustum(camera, options.near_m, options.far_m);
  scratch.grid.build(index_->surfaces, T_camera_world, frustum, gap_m(options));
  std::vector<int> visible;
  const std::vector<WorldCorner>& corners = index_->world.corners;
  for (int i = 0; i < static_cast<int>(corners.size()); ++i) {
    const Eigen::Vector3d x = T_camera_world * corners[i].position_m;
    if (frustum.contains(x) && !scratch.grid.hides(x)) visible.push_back(i);
  }
  return visible;
}

bool Visibility::sees(const Eigen::Vector3d& eye,
                      const Eigen::Vector3d& point,
                      const VisibilityOptions& options) const {
  const Eigen::Vector3d x = point - eye;
  const double gap = gap_m(options);
  std::vector<Eigen::Vector3d> touched;
  const PointInShadow where = classify(index_->surfaces, eye, x, gap, &touched);
  if (where != PointInShadow::on_border) return where == PointInShadow::outside;
  const auto around = points_around(x, touched);
  return std::any_of(around.begin(), around.end(), [&](const Eigen::Vector3d& y) {
    return classify(index_->surfaces, eye, y, gap) == PointInShadow::outside;
  });
}

}  // namespace vernier::sim
