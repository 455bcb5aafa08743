// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "calib/camera.h"
#include "calib/pose.h"
#include "stereo/segment.h"

namespace vernier::localise {

/// A segment as one view has it: both ends in the camera's frame, metres, with the covariance of
/// a x, y, z, b x, y, z, m².
struct SightedSegment {
  Eigen::Vector3d a_m, b_m;
  Eigen::Matrix<double, 6, 6> covariance_m2;
};

struct SegmentsOfView {
  Pose T_world_camera;
  std::vector<SightedSegment> segments;
};

struct JoinOptions {
  /// Of the squared Mahalanobis distance of a segment's infinite line, χ² with 4 degrees of
  /// freedom: 99.9 %.
  double gate = 18.47;
  double max_offset_m = 0.15;  ///< beyond this it is another line, whatever the covariance
  double max_turn_rad = 0.35;  ///< as above, for the angle between two
  double max_gap_m = 0.1;      ///< along the line, between what two sightings saw of it
  /// Segments with a larger standard deviation across themselves at an end are not joined: they
  /// would agree with everything near.
  double max_sigma_m = 0.1;
  double view_position_m = 0.005;  ///< standard deviation of each view's position, new at each view
  double view_turn_rad = 0.002;    ///< of its rotation, about each axis, likewise
  /// What all sightings of a line may share, of each end and axis: errors of poses that drift, bias
  /// of depths. It does not average away, and is added after the fusion.
  double shared_m = 0.01;
};

/// Which segment of which view, by their indices.
struct LineSighting {
  int view = 0, segment = 0;
  double low_m = 0, high_m = 0;  ///< what it saw, along the line from a_m to b_m; a_m is at 0
  double distance2 = 0;  ///< squared Mahalanobis distance from the joined line, 4 dimensions
};

/// A straight edge that several views agree on.
struct JoinedLine {
  Eigen::Vector3d a_m, b_m;                   ///< world frame
  Eigen::Matrix<double, 6, 6> covariance_m2;  ///< of a x, y, z, b x, y, z
  std::vector<LineSighting> sightings;        ///< by view, then segment
  int views = 0;                              ///< how many different ones saw it
  /// Sum of the sightings' squared distances from the fused line; with correct covariances χ² with
  /// 4 (sightings − 1) degrees of freedom.
  double chi2 = 0;
};

struct JoinedLines {
  std::vector<JoinedLine> lines;
  /// [view][segment]: its index in `lines`; none for a segment that is too uncertain to join.
  static constexpr int none = -1;
  std::vector<std::vector<int>> line_of;
};

/// Joins the segments of views whose poses are known into lines in space.
///
/// *Line.* In a frame with z along the line and x, y across it, an infinite line has 4 parameters
/// θ = (o_x, o_y, t_x, t_y): it is at o + s t at station s. The ends of a segment at stations s_a,
/// s_b are four measurements m = H θ, H = [I, s_a I; I, s_b I], with the covariance C that the
/// segment has across the line (its own error along itself says nothing of θ). So a sighting has
/// the information Hᵀ C⁻¹ H, and those of all sightings add up:
///
///     Λ = Σ Hᵀ C⁻¹ H,   Λ θ = Σ Hᵀ C⁻¹ m
///
/// solved anew about each estimate (Gauss and Newton). C holds the view's pose errors.
///
/// *Association.* A segment belongs to a line if rᵀ (C + H Λ⁻¹ Hᵀ)⁻¹ r with r = m − H θ is within
/// the gate, and both overlap along the line or nearly so; of several, to the one of the largest
/// likelihood. Two segments of one view that overlap are two edges, and never one line. Lines are
/// begun view by view. Then lines that agree are merged by the same test (with a wider gate, since
/// the sightings of one line that were divided at their middle look like two), lines whose
/// sightings others explain as well are dissolved, and all segments are associated anew with the
/// lines; three times. Lines are found by a grid of cells, so that cost grows with what is near.
///
/// *Ends.* Edges break more often than they are overlong, and views cut them off, so a line reaches
/// as far as its sightings do, without the farthest tenth of them: an end is where the k-th
/// farthest ends, k = max(2, n / 10) of n ≥ 3 sightings, 1 of fewer. Its variance along the line is
/// that of the sighting that gave it; whether the edge goes on is not in it.
///
/// The result does not depend on threads; it may depend on the order of views where associations
/// are ambiguous. Throws Error for numbers that are not finite, covariances that are not positive
/// semidefinite, and options out of range.
JoinedLines join_lines(std::span<const SegmentsOfView> views, const JoinOptions& options = {});

/// The part of a line that lies in a camera's image, the longest one, at depths of `near_m` at
/// least; nothing if there is none. What may hide it is not asked.
struct ProjectedLine {
  stereo::ImageSegment image_px;
  double t0 = 0, t1 = 1;  ///< from a_m to b_m
};
std::optional<ProjectedLine> projected_line(const JoinedLine& line,
                                            const Camera& camera,
                                            const Pose& T_camera_world,
                                            double near_m = 0.1);

}  // namespace vernier::localise
