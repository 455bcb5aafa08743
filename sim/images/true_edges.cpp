// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/true_edges.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "calib/camera.h"
#include "calib/pose.h"
#include "sim/images/image_truth.h"
#include "sim/images/wire_paint.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

using Eigen::Vector2d;
using Eigen::Vector3d;
using stereo::ImageSegment;

namespace {

/// Point t of a segment in the frame of a camera.
Vector3d point_of(const WorldSegment& s, double t, const Pose& T_camera_world) {
  return T_camera_world * Vector3d(s.a_m + t * (s.b_m - s.a_m));
}

EdgeEnd end_at(double t, const Vector3d& x, const RectifiedView& view, const VisibilityOptions& o) {
  constexpr double end_of_segment = 1e-6, near_px = 1.5;
  if (t < end_of_segment || t > 1 - end_of_segment) return EdgeEnd::corner;
  constexpr double limit_m = 1e-3;
  if (x.z() < o.near_m + limit_m || x.z() > o.far_m - limit_m) return EdgeEnd::border;
  const Vector2d left = project(view.rig.cameras[0], x);
  const double width = view.geometry.size_px[0], height = view.geometry.size_px[1];
  const double right = left.x() - view.geometry.disparity_px(x.z());
  const bool at_border = std::min(left.x(), right) < near_px || left.y() < near_px ||
                         std::max(left.x(), right) > width - 1 - near_px ||
                         left.y() > height - 1 - near_px;
  return at_border ? EdgeEnd::border : EdgeEnd::occluded;
}

std::vector<ImageSegment> images_of(const std::vector<VisibleInterval>& runs,
                                    const World& world,
                                    const Camera& camera,
                                    const Pose& T_camera_world) {
  std::vector<ImageSegment> images;
  images.reserve(runs.size());
  for (const VisibleInterval& run : runs) {
    const WorldSegment& s = world.segments[static_cast<std::size_t>(run.segment)];
    images.push_back({project(camera, point_of(s, run.t0, T_camera_world)),
                      project(camera, point_of(s, run.t1, T_camera_world))});
  }
  return images;
}

}  // namespace

std::string_view name(EdgeEnd end) {
  constexpr std::array<std::string_view, 3> names{"corner", "occluded", "border"};
  return names[static_cast<std::size_t>(end)];
}

ImageSegment TrueEdge::right_px() const {
  return {left_px.a_px - Vector2d(disparity_px[0], 0), left_px.b_px - Vector2d(disparity_px[1], 0)};
}

double TrueEdge::angle_rad() const {
  const Vector2d d = left_px.b_px - left_px.a_px;
  return std::atan2(std::abs(d.y()), std::abs(d.x()));
}

TrueEdges true_edges(const Visibility& visibility,
                     const std::vector<EdgeAppearance>& appearances,
                     const RectifiedView& view,
                     const VisibilityOptions& options) {
  const World& world = visibility.world();
  VisibilityOptions any_length = options;
  any_length.min_length_px = 0;
  const auto left =
      visibility.visible_intervals(view.rig.cameras[0], view.T_left_world, any_length);
  const auto right =
      visibility.visible_intervals(view.rig.cameras[1], view.T_right_world, any_length);
  TrueEdges edges;
  edges.of_eye[0] = images_of(left, world, view.rig.cameras[0], view.T_left_world);
  edges.of_eye[1] = images_of(right, world, view.rig.cameras[1], view.T_right_world);
  const auto before = [](const VisibleInterval& run, int segment) { return run.segment < segment; };
  for (std::size_t i = 0; i < left.size(); ++i) {
    const VisibleInterval& run = left[i];
    auto other = std::lower_bound(right.begin(), right.end(), run.segment, before);
    for (; other != right.end() && other->segment == run.segment; ++other) {
      const double t0 = std::max(run.t0, other->t0), t1 = std::min(run.t1, other->t1);
      if (t0 >= t1) continue;
      const WorldSegment& s = world.segments[static_cast<std::size_t>(run.segment)];
      const Vector3d a = point_of(s, t0, view.T_left_world), b = point_of(s, t1, view.T_left_world);
      TrueEdge edge;
      edge.left_px = {project(view.rig.cameras[0], a), project(view.rig.cameras[0], b)};
      if (edge.left_px.length_px() < options.min_length_px) continue;
      edge.disparity_px = {view.geometry.disparity_px(a.z()), view.geometry.disparity_px(b.z())};
      edge.ends = {end_at(t0, a, view, options), end_at(t1, b, view, options)};
      edge.along = {t0, t1};
      edge.of_eye = {static_cast<int>(i), static_cast<int>(other - right.begin())};
      edge.segment = run.segment;
      edge.appearance = appearances[static_cast<std::size_t>(run.segment)];
      edge.depth_m = (a.z() + b.z()) / 2;
      edges.both.push_back(edge);
    }
  }
  return edges;
}

}  // namespace vernier::sim::internal
