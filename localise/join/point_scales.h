// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "localise/joined_lines.h"

namespace vernier::localise::internal {

/// By what the points of all views should be multiplied for their lines to agree: all three
/// coordinates by 1 + `depth` (a wrong unit or scale of depth maps, a wrong baseline), and x and y,
/// in the camera's frame, by 1 + `across` beside (a wrong focal length of a camera with depths).
struct PointScales {
  double depth = 0, across = 0;
  double depth_sigma = 0, across_sigma = 0;
  bool joined_again = false;  ///< by joined_point_scales()

  /// Whether the motion tells them: turning on the spot does not, nor a straight way ahead
  /// `across`.
  bool tells_depth() const { return depth_sigma < most_sigma; }
  bool tells_across() const { return across_sigma < most_sigma; }
  static constexpr double most_sigma = 0.02;
};

/// From the sightings of joined lines: the poses are metric, so that a line that is seen from near
/// and from far tells whether its depths are in the poses' unit. With m_k and C_k the measurements
/// of a sighting across its line and their covariance, H_k the line's, and D_k the derivative of
/// m_k by both scales x at the fitted line (a Gauss–Newton step from x = 0, lines eliminated),
///
///     Λ = Σ_k Hᵀ C⁻¹ H,   E_k = D_k − H_k Λ⁻¹ Σ_j H_jᵀ C_j⁻¹ D_j
///     I = Σ E_kᵀ C_k⁻¹ E_k,   x = −I⁻¹ Σ E_kᵀ C_k⁻¹ r_k
///
/// The covariance is the sandwich clustered by view, whose segments share the error of its pose.
/// Sightings that a wrong scale has put outside the gate of the association are missing, so that an
/// error is found too small, by a factor of 3 to 6 at a few percent (joined_point_scales finds it).
/// Nothing for fewer than 10 views with lines that others see too, or where they do not determine
/// both.
std::optional<PointScales> point_scales(std::span<const SegmentsOfView> views,
                                        const JoinedLines& joined,
                                        const JoinOptions& options);

/// The scales at which point_scales() of the views so scaled, joined again, are zero: by secants
/// from those of the views as they are, `first`, a few joins. What the motion does not tell stays
/// as it is. The standard deviations are the last ones, taken along.
PointScales joined_point_scales(std::span<const SegmentsOfView> views,
                                const PointScales& first,
                                const JoinOptions& options);

}  // namespace vernier::localise::internal
