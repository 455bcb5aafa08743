// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>

#include "calib/pose.h"
#include "sim/images/image_scene.h"
#include "sim/images/ray_scene.h"

namespace vernier::sim::internal {

inline constexpr int no_face = -1;

/// The eye of a view, its rays and what they hit.
class Eye {
 public:
  Eye(const ImageScene& scene, const Pose& T_camera_world)
      : scene_(scene),
        R_world_camera_(T_camera_world.R.transpose()),
        at_(T_camera_world.inverse().t),
        from_((at_ - scene.middle_m).cast<float>()) {}

  const ImageScene& scene() const { return scene_; }
  const Eigen::Vector3d& at() const { return at_; }

  /// World direction of a ray (x / z, y / z): its length is 1 / cos of the angle to the axis, so a
  /// distance in units of it is the depth along the axis.
  Eigen::Vector3d direction(const Eigen::Vector2d& ray) const {
    return R_world_camera_ * Eigen::Vector3d(ray.x(), ray.y(), 1);
  }

  RayBundle bundle(const Eigen::Vector2d* rays, int count) const {
    RayBundle b;
    b.origin_m = from_;
    b.count = count;
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3f d = direction(rays[i]).cast<float>();
      const auto k = static_cast<std::size_t>(i);
      b.x[k] = d.x();
      b.y[k] = d.y();
      b.z[k] = d.z();
    }
    return b;
  }

  /// Depth at which a ray meets a plane.
  template <class Plane>
  double depth(const Plane& plane, const Eigen::Vector3d& direction) const {
    return (plane.distance_m - plane.normal.dot(at_)) / plane.normal.dot(direction);
  }

 private:
  const ImageScene& scene_;
  Eigen::Matrix3d R_world_camera_;
  Eigen::Vector3d at_;
  Eigen::Vector3f from_;
};

/// What the rays of a bundle see: a face and the figures painted over it.
struct SeenSurface {
  int face = no_face;
  std::array<int, BundleCrossings::limit> figures;  ///< ascending
  int figure_count = 0;

  bool operator==(const SeenSurface& other) const {
    return face == other.face && figure_count == other.figure_count &&
           std::equal(figures.begin(), figures.begin() + figure_count, other.figures.begin());
  }
};

/// Traces bundles of rays from an eye.
class Tracer {
 public:
  explicit Tracer(const Eye& eye) : eye_(eye) {}

  void trace(const RayBundle& rays, std::array<SeenSurface, bundle_size>& seen);

 private:
  /// The figures within 3 cm in front of the face, or 1 mm behind it, across their plane.
  void add_figures(std::size_t ray, const Eigen::Vector3f& direction, SeenSurface& seen) const;

  const Eye& eye_;
  BundleHits hits_;
  BundleCrossings crossings_;
};

/// Depth of what a ray sees: of the smallest figure there, which is the innermost of nested ones,
/// else of the face.
double depth_of(const Eye& eye, const SeenSurface& seen, const Eigen::Vector3d& direction);

}  // namespace vernier::sim::internal
