// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/visibility.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "sim/visibility/box_tree.h"
#include "sim/visibility/convex_pieces.h"
#include "sim/visibility/near_occluders.h"
#include "sim/visibility/shadow.h"
#include "sim/visibility/shadow_grid.h"
#include "sim/visibility/view_frustum.h"
#include "sim/visibility/view_sets.h"
#include "sim/world.h"

namespace vernier::sim {

using namespace internal;
using Eigen::AlignedBox3d;

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
  NearOccluders near;
  ShadowGrid grid;
  std::vector<OccludedInterval> hidden;
  std::vector<Stretch> unhidden, inside, seen;
  std::vector<int> near_pieces, near_features;
  std::vector<ShadowSide> sides;
};
thread_local Scratch scratch;

/// Visibility of a point x from an eye, with respect to the surfaces `near` the ray.
PointInShadow classify(const ConvexSurfaces& surfaces,
                       const std::vector<int>& near,
                       const Eigen::Vector3d& eye,
                       const Eigen::Vector3d& x,
                       double gap,
                       std::vector<Eigen::Vector3d>* touched = nullptr) {
  PointInShadow result = PointInShadow::outside;
  for (const int i : near) {
    const ConvexSurface& piece = surfaces.pieces[i];
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
    for (int k = 0; k < piece.vertex_count; ++k) {
      const Eigen::Vector3d from = p[k] - eye;
      const Eigen::Vector3d to = p[k + 1 < piece.vertex_count ? k + 1 : 0] - eye;
      scratch.sides.push_back(flip ? shadow_side(to, from) : shadow_side(from, to));
    }
    const Shadow shadow{flip ? -piece.normal : piece.normal, distance, scratch.sides};
    const PointInShadow where = point_in_shadow(shadow, x, gap, touched);
    if (where == PointInShadow::inside) return where;
    if (where == PointInShadow::on_border) result = where;
  }
  return result;
}

BoxTree tree_of(const ConvexSurfaces& surfaces) {
  std::vector<AlignedBox3d> boxes(surfaces.pieces.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    boxes[i] = box_of(surfaces, surfaces.pieces[i]);
  }
  return BoxTree(std::move(boxes));
}

BoxTree tree_of(const std::vector<WorldSegment>& segments) {
  std::vector<AlignedBox3d> boxes(segments.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    boxes[i].extend(segments[i].a_m);
    boxes[i].extend(segments[i].b_m);
  }
  return BoxTree(std::move(boxes));
}

BoxTree tree_of(const std::vector<WorldCorner>& corners) {
  std::vector<AlignedBox3d> boxes;
  boxes.reserve(corners.size());
  for (const WorldCorner& corner : corners) boxes.emplace_back(corner.position_m);
  return BoxTree(std::move(boxes));
}

}  // namespace

struct Visibility::Index {
  Index(const World& whole, VisibilityMethod how)
      : world(whole),
        method(how),
        surfaces(convex_surfaces(whole)),
        large(surfaces),
        pieces(tree_of(surfaces)),
        segments(tree_of(whole.segments)),
        corners(tree_of(whole.corners)) {}

  /// Prepares the shadows of a view, and the features of a tree that can be in it, if one is given.
  void prepare(const ViewFrustum& frustum,
               const Pose& T,
               const BoxTree* features,
               double gap) const {
    const ViewVolume volume = frustum.volume(T);
    scratch.near.choose(surfaces, large, T.inverse().t, volume, gap);
    const auto meets = [&](const AlignedBox3d& box) {
      return volume.may_meet(box) && !scratch.near.hide(box);
    };
    pieces.find(meets, scratch.near_pieces);
    if (features) features->find(meets, scratch.near_features);
    scratch.grid.build(surfaces, scratch.near_pieces, T, frustum, gap);
  }

  /// The segments of the view set that is nearest to a camera.
  std::span<const int> set_at(const Pose& T) const {
    const Eigen::Vector3d eye = T.inverse().t, axis = T.R.row(2).transpose();
    const ViewSet* set =
        nearest_set(world.view_sets, {eye.x(), eye.y(), std::atan2(axis.y(), axis.x())});
    return set ? std::span<const int>(set->segments) : std::span<const int>();
  }

  /// Visible runs of some segments, of the view that was prepared.
  std::vector<VisibleInterval> runs_of(std::span<const int> candidates,
                                       const ViewFrustum& frustum,
                                       const Camera& camera,
                                       const Pose& T,
                                       double min_length_px) const {
    Scratch& s = scratch;
    std::vector<VisibleInterval> runs;
    for (const int i : candidates) {
      const Eigen::Vector3d a = T * world.segments[i].a_m;
      const Eigen::Vector3d b = T * world.segments[i].b_m;
      Stretch open;
      if (!frustum.clip(a, b, open)) continue;
      s.hidden.clear();
      if (method == VisibilityMethod::exact && !s.grid.hide(a, b, open, s.hidden)) continue;
      frustum.in_image(a, b, open, s.inside);
      subtract_intervals(open, s.hidden, s.unhidden);
      intersect(s.unhidden, s.inside, s.seen);
      const auto pixel = [&](double t) { return project(camera, a + t * (b - a)); };
      for (int run = 0; run < static_cast<int>(s.seen.size()); ++run) {
        const auto [t0, t1] = s.seen[run];
        if (min_length_px > 0 && (pixel(t1) - pixel(t0)).norm() < min_length_px) continue;
        runs.push_back({i, run, t0, t1});
      }
    }
    return runs;
  }

  const World& world;
  VisibilityMethod method;
  ConvexSurfaces surfaces;
  LargeSurfaces large;
  BoxTree pieces, segments, corners;
};

Visibility::Visibility(const World& world, VisibilityMethod method)
    : index_(new Index(world, method)) {
  if (method == VisibilityMethod::view_sets && world.view_sets.empty()) {
    throw Error("the world", "has no view sets",
                "add [[view_dependency]], or make them with vernier world sets");
  }
}
Visibility::~Visibility() = default;
Visibility::Visibility(Visibility&&) noexcept = default;

const World& Visibility::world() const { return index_->world; }

std::vector<VisibleInterval> Visibility::visible_intervals(const Camera& camera,
                                                           const Pose& T_camera_world,
                                                           const VisibilityOptions& options) const {
  check(T_camera_world, options);
  const ViewFrustum frustum(camera, options.near_m, options.far_m);
  if (index_->method == VisibilityMethod::view_sets) {
    return index_->runs_of(index_->set_at(T_camera_world), frustum, camera, T_camera_world,
                           options.min_length_px);
  }
  index_->prepare(frustum, T_camera_world, &index_->segments, gap_m(options));
  return index_->runs_of(scratch.near_features, frustum, camera, T_camera_world,
                         options.min_length_px);
}

std::vector<VisibleInterval> Visibility::visible_intervals_of(
    std::span<const int> segments,
    const Camera& camera,
    const Pose& T_camera_world,
    const VisibilityOptions& options) const {
  check(T_camera_world, options);
  const ViewFrustum frustum(camera, options.near_m, options.far_m);
  if (index_->method == VisibilityMethod::view_sets) {
    return index_->runs_of(segments, frustum, camera, T_camera_world, options.min_length_px);
  }
  index_->prepare(frustum, T_camera_world, nullptr, gap_m(options));
  return index_->runs_of(segments, frustum, camera, T_camera_world, options.min_length_px);
}

std::vector<int> Visibility::visible_corners(const Camera& camera,
                                             const Pose& T_camera_world,
                                             const VisibilityOptions& options) const {
  check(T_camera_world, options);
  const ViewFrustum frustum(camera, options.near_m, options.far_m);
  index_->prepare(frustum, T_camera_world, &index_->corners, gap_m(options));
  std::vector<int> visible;
  const std::vector<WorldCorner>& corners = index_->world.corners;
  for (const int i : scratch.near_features) {
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
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(1e-6);  // larger than any tolerance
  index_->pieces.find(
      [&](const AlignedBox3d& box) {
        return meets_box({box.min() - margin, box.max() + margin}, eye, point);
      },
      scratch.near_pieces);
  const std::vector<int>& near = scratch.near_pieces;
  const PointInShadow where = classify(index_->surfaces, near, eye, x, gap, &touched);
  if (where != PointInShadow::on_border) return where == PointInShadow::outside;
  const auto around = points_around(x, touched);
  return std::any_of(around.begin(), around.end(), [&](const Eigen::Vector3d& y) {
    return classify(index_->surfaces, near, eye, y, gap) == PointInShadow::outside;
  });
}

}  // namespace vernier::sim
