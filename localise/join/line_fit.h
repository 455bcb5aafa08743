// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "calib/pose.h"
#include "localise/joined_lines.h"

namespace vernier::localise::internal {

/// A sighting in the world frame, its covariance with the view's pose errors.
struct WorldSighting {
  int view = 0, segment = 0;
  Eigen::Vector3d a_m, b_m;
  Eigen::Matrix<double, 6, 6> covariance_m2;
};

/// Whether a symmetric matrix has no eigenvalue below 0 (1e-9 of the largest are rounding), and one
/// above.
bool is_semidefinite(const Eigen::Matrix<double, 6, 6>& covariance_m2);

WorldSighting in_world(const SightedSegment& segment,
                       const Pose& T_world_camera,
                       const JoinOptions& options);

/// Numerically singular covariances, as of rays exactly known across, become definite: 0.01 mm.
void make_definite(WorldSighting& sighting);

/// Larger standard deviation across itself of a segment's ends, metres.
double sigma_across(const WorldSighting& sighting);

/// A line's frame: origin on it, z along it.
struct LineFrame {
  Eigen::Vector3d origin_m;
  Eigen::Matrix3d axes;  ///< columns x, y, z

  double station(const Eigen::Vector3d& p) const { return axes.col(2).dot(p - origin_m); }
  Eigen::Vector2d across(const Eigen::Vector3d& p) const {
    return axes.leftCols<2>().transpose() * (p - origin_m);
  }
};

LineFrame frame_of(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m);

/// An infinite line as far as it is known: θ is 0 in its frame.
struct FittedLine {
  LineFrame frame;
  Eigen::Matrix4d information;  ///< of o_x, o_y, t_x, t_y
  Eigen::Matrix4d covariance;
};

/// What a sighting says of a line: m, its stations, C.
struct LineMeasurement {
  Eigen::Vector4d across_m;  ///< a x, y, b x, y
  std::array<double, 2> station_m;
  Eigen::Matrix4d covariance_m2;

  Eigen::Matrix4d by_line() const;  ///< H
};

LineMeasurement measured(const WorldSighting& sighting, const LineFrame& frame);

/// The fused line of sightings, at least one.
FittedLine fitted(std::span<const WorldSighting* const> sightings);

/// Covariance of the points at two stations: of the line across it, and the given variances along.
Eigen::Matrix<double, 6, 6> covariance_of_ends(const FittedLine& line,
                                               double low_m,
                                               double high_m,
                                               const std::array<double, 2>& along_m2);

/// How far a measurement is from a line.
struct LineDistance {
  double mahalanobis2 = 0;
  double cost = 0;  ///< −2 log likelihood but for a constant: mahalanobis2 + log |S|
};

/// With S = C + H Λ⁻¹ Hᵀ.
LineDistance distance(const LineMeasurement& m, const FittedLine& line);

/// rᵀ C⁻¹ r: what a sighting adds to the sum of squares of a fit.
double residual2(const LineMeasurement& m);

}  // namespace vernier::localise::internal
