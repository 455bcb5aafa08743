// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "calib/camera.h"
#include "calib/pose.h"
#include "sim/visibility/shadow.h"

namespace vernier::sim::internal {

/// An axis-aligned rectangle of normalised image coordinates (x / z, y / z).
struct ImageBox {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  bool contains(const Eigen::Vector2d& x) const {
    return x[0] >= x0 && x[0] <= x1 && x[1] >= y0 && x[1] <= y1;
  }
};

/// What a camera can see, from its eye on, wider by 1 mm: world frame.
class ViewVolume {
 public:
  using Plane = Eigen::Hyperplane<double, 3>;  ///< positive inside
  ViewVolume(const Eigen::AlignedBox3d& around, const std::array<Plane, 4>& sides);

  /// False only for boxes outside; true for some of those too.
  bool may_meet(const Eigen::AlignedBox3d& box) const {
    if (!around_.intersects(box)) return false;
    const Eigen::Vector3d centre = 0.5 * (box.min() + box.max());
    const Eigen::Vector3d half = 0.5 * (box.max() - box.min());
    // of each side, its distance from the box's innermost corner
    return (normals_ * centre + reach_ * half + offsets_).minCoeff() >= 0;
  }

 private:
  Eigen::AlignedBox3d around_;
  Eigen::Matrix<double, 4, 3> normals_, reach_;  // reach_: their absolute values
  Eigen::Vector4d offsets_;
};

/// The viewing volume of a camera: between two depths, and inside its image.
///
/// Distortion bends its sides, so it is bounded by two pyramids: `outer` contains every ray of the
/// image, `inner` contains only rays of the image. Between them the image border is found on the
/// distorted curve of the segment. Outside `outer`, and farther from the axis than any pixel,
/// distortion models may fold back into the image: this region is excluded.
class ViewFrustum {
 public:
  /// Throws Error for depths other than 0 < near < far, a camera without an image or with the wrong
  /// number of parameters, and a distortion that cannot be inverted at the image centre. If it
  /// folds before the border, points beyond the fold are not imaged. Keeps a reference to `camera`.
  ViewFrustum(const Camera& camera, double near_m, double far_m);

  /// Interval of the segment a b (camera frame, metres) between near and far and in the outer
  /// pyramid; false if there is none.
  bool clip(const Eigen::Vector3d& a, const Eigen::Vector3d& b, Stretch& stretch) const;

  /// Intervals of `clipped` (from `clip`) whose projections lie in the image; usually one, two if
  /// barrel distortion bends the segment out of the image in between.
  void in_image(const Eigen::Vector3d& a,
                const Eigen::Vector3d& b,
                const Stretch& clipped,
                std::vector<Stretch>& inside) const;

  /// Whether the point projects into the image, between near and far.
  bool contains(const Eigen::Vector3d& point) const;

  /// The eye and the volume in the world's frame.
  ViewVolume volume(const Pose& T_camera_world) const;

  const ImageBox& outer() const { return outer_; }
  double near_m() const { return near_m_; }
  double far_m() const { return far_m_; }

 private:
  void bound_border();
  /// Fractions s of the projection, ascending from 0 to 1, that separate parts inside and outside
  /// the image.
  void cut_at_border(const ProjectedSegment& picture, std::vector<double>& cuts) const;

  const Camera& camera_;
  double near_m_, far_m_;
  ImageBox outer_, inner_;
  double outer_radius2_ = 0;
};

}  // namespace vernier::sim::internal
