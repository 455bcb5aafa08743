// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <set>

#include "sim/world.h"

namespace vernier {

/// Rounds to the tenth of a millimetre that a world file keeps, so that a generated world and its
/// text say the same to the bit.
double to_grid(double value_m);
Eigen::Vector3d to_grid(const Eigen::Vector3d& value_m);

/// A frame turned about z by whole quarter turns; exact, as no sine is needed.
struct QuarterFrame {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  int quarters = 0;

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const;
  Eigen::AlignedBox3d operator*(const Eigen::AlignedBox3d& box) const;
};

/// The faces of a box that become opaque surfaces. y points away from the wall, hence the names.
enum BoxFaces : unsigned {
  kNoFace = 0,
  kLeftFace = 1,
  kRightFace = 2,
  kBackFace = 4,
  kFrontFace = 8,
  kBottomFace = 16,
  kTopFace = 32,
  kAllFaces = 63,
  kStandingFaces = kAllFaces - kBottomFace,    ///< on the floor
  kLeaningFaces = kStandingFaces - kBackFace,  ///< on the floor with its back to a wall
  kHangingFaces = kAllFaces - kTopFace,        ///< from the ceiling
  kUprightFaces = kLeftFace + kRightFace + kBackFace + kFrontFace,
};

/// Collects features in a frame. Lines that coincide are kept once, and corners are found where
/// lines that are not parallel end at the same point.
class Shapes {
 public:
  QuarterFrame frame;  ///< of what is added next

  void line(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m);
  /// A rectangle in the plane y = `y_m`, as a picture on a wall.
  void upright_rectangle(double x0_m, double z0_m, double x1_m, double z1_m, double y_m);
  /// A rectangle in the plane z = `z_m`.
  void level_rectangle(double x0_m, double y0_m, double x1_m, double y1_m, double z_m);
  /// The twelve edges of a box, and the surfaces of some of its faces.
  void box(const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m, unsigned faces = kAllFaces);
  /// A leg or a panel below a board: the edges but those of its top.
  void leg(const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m, unsigned faces = kNoFace);
  void surfaces_of_box(const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m, unsigned faces);

  FeatureSet features() const;

 private:
  using GridPoint = std::array<std::int64_t, 3>;

  FeatureSet features_;
  std::set<std::array<GridPoint, 2>> seen_;
};

/// The box around all segments.
Eigen::AlignedBox3d bounds(const FeatureSet& features);

}  // namespace vernier
