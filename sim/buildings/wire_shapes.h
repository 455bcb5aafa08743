// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <set>

#include "sim/world.h"

namespace vernier::sim::internal {

/// Rounds to 0.1 mm, the resolution of a world file, so that a generated world and its text are
/// identical to the bit.
double to_grid(double value_m);
Eigen::Vector3d to_grid(const Eigen::Vector3d& value_m);

/// A frame rotated about z by multiples of 90°; exact, since no sine is needed.
struct QuarterFrame {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  int quarters = 0;

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const;
  Eigen::AlignedBox3d operator*(const Eigen::AlignedBox3d& box) const;
};

/// The faces of a box that become opaque surfaces. y points away from the wall, hence the names.
enum BoxFaces : unsigned {
  no_face = 0,
  left_face = 1,
  right_face = 2,
  back_face = 4,
  front_face = 8,
  bottom_face = 16,
  top_face = 32,
  all_faces = 63,
  standing_faces = all_faces - bottom_face,    ///< on the floor
  leaning_faces = standing_faces - back_face,  ///< on the floor, back against a wall
  hanging_faces = all_faces - top_face,        ///< from the ceiling
  upright_faces = left_face + right_face + back_face + front_face,
};

/// Collects features in a frame. Coincident lines are kept once; corners are created where
/// non-parallel lines end at the same point.
class Shapes {
 public:
  QuarterFrame frame;  ///< of the features added next

  void line(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m);
  /// A rectangle in the plane y = `y_m`, such as a picture on a wall.
  void upright_rectangle(double x0_m, double z0_m, double x1_m, double z1_m, double y_m);
  /// A rectangle in the plane z = `z_m`.
  void level_rectangle(double x0_m, double y0_m, double x1_m, double y1_m, double z_m);
  /// The twelve edges of a box, and the surfaces of some of its faces.
  void box(const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m, unsigned faces = all_faces);
  /// A leg or a panel below a board: the edges except those of its top.
  void leg(const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m, unsigned faces = no_face);
  void surfaces_of_box(const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m, unsigned faces);

  FeatureSet features() const;

 private:
  using GridPoint = std::array<std::int64_t, 3>;

  FeatureSet features_;
  std::set<std::array<GridPoint, 2>> seen_;
};

/// The bounding box of all segments.
Eigen::AlignedBox3d bounds(const FeatureSet& features);

}  // namespace vernier::sim::internal
