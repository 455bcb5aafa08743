// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "calib/camera.h"
#include "calib/pose.h"
#include "sim/world.h"

namespace vernier::sim {

struct VisibilityOptions {
  double near_m = 0.1;          ///< minimum depth along the optical axis
  double far_m = 30;            ///< maximum depth
  double min_length_px = 10;    ///< shorter visible runs are not detected as lines
  double surface_gap_m = 1e-3;  ///< a point within this distance behind a surface counts as on it
};

/// A visible run of a segment in one camera, x(t) = a + t (b - a), t in [t0, t1].
struct VisibleInterval {
  int segment = 0;  ///< index into World::segments
  int run = 0;      ///< index of the run on this segment, from a to b
  double t0 = 0, t1 = 1;
};

enum class VisibilityMethod {
  exact,
  /// The memo's way: what the nearest of the world's view sets names is seen, whole as far as it
  /// lies in the image, and nothing else; from a pose that no set reaches nothing is. Corners are
  /// exact all the same.
  view_sets,
};

/// Hidden-line removal in a world of opaque surfaces, exact up to rounding.
///
/// A point x is hidden from the eye o by a convex surface P with plane n·x = d if and only if it
/// lies in P's shadow: beyond the plane as seen from o, and inside every half-space through o and
/// an edge of P. All of these are linear along a segment, so each surface hides one interval of t,
/// computed analytically in double precision (idea: Appel, "The notion of quantitative
/// invisibility", 1967). A grid over the view skips irrelevant surfaces.
class Visibility {
 public:
  /// Keeps a reference to `world`, which must outlive this. Splits non-convex surfaces into convex
  /// ones once. Throws Error for view sets of a world that has none.
  explicit Visibility(const World& world, VisibilityMethod method = VisibilityMethod::exact);
  ~Visibility();
  Visibility(Visibility&&) noexcept;

  /// Visible runs of all segments for a camera at T_camera_world: inside the image (distortion
  /// included), between near and far, not hidden; ordered by segment, then by t.
  std::vector<VisibleInterval> visible_intervals(const Camera& camera,
                                                 const Pose& T_camera_world,
                                                 const VisibilityOptions& options = {}) const;

  /// The same for some segments only: indices into the world's, ascending. By view sets all of
  /// them are taken as the set: the right eye of a pair has that of the left.
  std::vector<VisibleInterval> visible_intervals_of(std::span<const int> segments,
                                                    const Camera& camera,
                                                    const Pose& T_camera_world,
                                                    const VisibilityOptions& options = {}) const;

  /// Indices of the visible corners, ascending.
  std::vector<int> visible_corners(const Camera& camera,
                                   const Pose& T_camera_world,
                                   const VisibilityOptions& options = {}) const;

  /// Whether no surface hides `point` from `eye` (world frame, metres).
  bool sees(const Eigen::Vector3d& eye,
            const Eigen::Vector3d& point,
            const VisibilityOptions& options = {}) const;

  const World& world() const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace vernier::sim
