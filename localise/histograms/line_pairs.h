// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "localise/histograms/pair_entry.h"
#include "localise/pgh.h"

namespace vernier::localise::internal {

/// Error of a line's position: the standard deviation of an end point in any direction, in the
/// line's unit. Both ends err independently, or the line as a whole.
struct LineError {
  double sigma = 0;
  bool as_a_whole = false;
};

/// A segment that points from a to b; the ends must differ.
template <int dimensions>
struct PointingLine {
  using Point = Eigen::Matrix<double, dimensions, 1>;

  PointingLine(const Point& from, const Point& to, const LineError& line_error)
      : a(from),
        b(to),
        length((to - from).norm()),
        direction((to - from) / length),
        error(line_error) {}

  Point a, b;
  double length;
  Point direction;  ///< of unit length
  LineError error;
};

using PlaneLine = PointingLine<2>;
using SpaceLine = PointingLine<3>;

// Entries for the histogram of `reference`, with neither band nor weight. With blur `per_entry`, of
// lines with ends that err by s and a point at t along the reference from its middle and at w along
// the other line from its middle,
//
//     σ_θ² = 2 s_r²/L_r² + 2 s_o²/L_o²,
//     σ_d² = s_r² (1/2 + 2 t²/L_r²) + s_o² (1/2 + 2 w²/L_o²),
//
// the propagated variances of a line through two points; s_r² and s_o² alone for lines that err as
// a whole, whose angle does not. σ_d² is averaged over each stretch. That errors in angle and
// distance are correlated is neglected.

/// See image_histograms.
PairEntry pair_in_plane(const PlaneLine& reference,
                        const PlaneLine& other,
                        const PghOptions& options);

/// A point, at its distance and no angle. See ground_histograms.
PairEntry point_in_plane(const PlaneLine& reference,
                         const Eigen::Vector2d& point,
                         double sigma,
                         const PghOptions& options);

/// See spatial_histograms. The distances of a segment's points follow a hyperbola, which falls to
/// the point nearest the reference and rises from there; each branch is divided into stretches.
PairEntry pair_in_space(const SpaceLine& reference,
                        const SpaceLine& other,
                        const PghOptions& options);

}  // namespace vernier::localise::internal
