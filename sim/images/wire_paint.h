// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "sim/images/surface_appearance.h"
#include "sim/world.h"

namespace vernier::sim::internal {

/// What makes a segment of the wire frame visible in an image.
enum class EdgeAppearance {
  border,   ///< it borders a surface: two surfaces, or what is behind, differ in brightness
  outline,  ///< of a plane figure just in front of a surface, of another reflectance: one step
  line,     ///< a line on, or just in front of, a surface: a painted stripe, two opposite steps
  bar,      ///< free in space: a thin bar
};
inline constexpr int appearance_count = 4;
std::string_view name(EdgeAppearance appearance);

/// A plane figure that multiplies the reflectance of the surface that it lies on.
struct PaintedFigure {
  std::vector<Eigen::Vector3d> polygon_m;
  double factor = 1;
};

/// A thin bar of square section along a segment.
struct WireBar {
  Eigen::Vector3d a_m, b_m;
  int segment = 0;
  double reflectance = 0.5;
};

struct WirePaint {
  std::vector<EdgeAppearance> of_segment;  ///< one per segment of the world
  std::vector<PaintedFigure> figures;
  std::vector<WireBar> bars;
};

/// Segments that border no surface have to be painted to be seen. One that runs within 25 mm of a
/// surface, over its length and parallel to it, becomes
///
///  - part of a figure, if the segments of its object close to a plane loop of which every inside
///  is
///    that near to a surface too: a door's panel, a notice board. The figure has one reflectance;
///  - else a stripe of `line_width_m`.
///
/// Figures and stripes stay where the segment is, in front of the surface, and hide nothing. All
/// others become bars. Reflectances: counter (segment within the object, template's name), source
/// `surface_appearance`, eye 3; the same for all instances. Throws Error for options out of range.
WirePaint wire_paint(const World& world, const SurfaceAppearanceOptions& options);

}  // namespace vernier::sim::internal
