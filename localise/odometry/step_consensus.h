// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/draw_sources.h"
#include "localise/odometry.h"
#include "localise/odometry/pair_projection.h"
#include "localise/odometry/step_refinement.h"
#include "localise/place.h"

namespace vernier::localise::internal {

/// A link whose corners have points at both moments.
struct TriangulatedLink {
  CornerLink link;
  LinkedCorner corner;
  Eigen::Vector3d x_to_m;              ///< left camera's frame at the later moment
  Eigen::Matrix3d covariance_from_m2;  ///< of corner.x_from_m
  Eigen::Matrix4d
      to_covariance_px2;  ///< of corner.to_px, for the gate: that of the rig's error included
  Eigen::Matrix3d covariance_to_m2;  ///< of x_to_m
};

/// The point of a corner in the frame of its rig's left camera.
struct TriangulatedCorner {
  Eigen::Vector3d x_m;
  Eigen::Matrix3d covariance_m2;
  Eigen::Matrix4d calibration_px2;  ///< of its pixels' distance from those of x, by the rig's error
};

/// None if its pixels have no point, or do not meet within the gate (one degree of freedom).
/// `calibration` is empty or of the rig's parameters.
std::optional<TriangulatedCorner> triangulated(PairProjector& projector,
                                               const StereoCorner& corner,
                                               const Eigen::MatrixXd& calibration,
                                               double gate);

TriangulatedLink triangulated_link(const CornerLink& link,
                                   const StereoCorner& from,
                                   const TriangulatedCorner& earlier,
                                   const StereoCorner& to,
                                   const TriangulatedCorner& later);

/// The links whose pixels have points that project to them within the gate, at both moments.
std::vector<TriangulatedLink> triangulated_links(const Rig& rig,
                                                 std::span<const StereoCorner> from,
                                                 std::span<const StereoCorner> to,
                                                 std::span<const CornerLink> links,
                                                 const StepOptions& options);

/// How a motion follows from the fewest links that determine it.
struct MinimalMotion {
  std::size_t links = 3;
  vernier::internal::DrawSource source;  ///< of the draws of links
  /// Of links with these indices; none if they determine no motion.
  std::function<std::optional<Pose>(std::span<const std::size_t>)> solve;
  std::vector<double> weights = {};  ///< of the links, in draws and sums; empty: equal
};

/// Of each link 1 / n, with n the links in its cell of 12 x 12 of the left image at the earlier
/// moment, so that the sum is the number of cells with links: what covers most of the image counts,
/// not what has most texture.
std::vector<double> weights_by_cell(const Rig& rig, const std::vector<TriangulatedLink>& links);

struct AgreedMotion {
  Pose T_from_to;
  double sum = 0;  ///< of the weighted squares of all links, each at most the gate (MSAC)
};

/// The motion on which most links agree, of those drawn by `minimal`; std::nullopt if there is
/// none. `to_rig` is that of the later moment.
std::optional<AgreedMotion> consensus(const Rig& to_rig,
                                      const std::vector<TriangulatedLink>& links,
                                      const StepOptions& options,
                                      const MinimalMotion& minimal);

/// The same in space, of three links weighed by cell.
std::optional<Pose> consensus(const Rig& rig,
                              const std::vector<TriangulatedLink>& links,
                              const StepOptions& options);

/// Squared distance (Mahalanobis, 4 degrees of freedom) beyond which a link does not agree.
double link_gate(double gate_probability);

/// Indices of the links within the gate of a motion. `to_rig` is that of the later moment.
std::vector<int> agreeing_links(const Rig& to_rig,
                                const std::vector<TriangulatedLink>& links,
                                const Pose& T_from_to,
                                double gate_probability);

/// The links whose squared distance from a motion exceeds `least`.
std::vector<TriangulatedLink> links_beyond(const Rig& to_rig,
                                           const std::vector<TriangulatedLink>& links,
                                           const Pose& T_from_to,
                                           double least);

/// How much the links support a motion: the sum of 1 - d² / gate over those that agree.
double support_of(const Rig& to_rig,
                  const std::vector<TriangulatedLink>& links,
                  const Pose& T_from_to,
                  double gate_probability);

struct SettledStep {
  RefinedStep refined;
  std::vector<int> agreeing;  ///< indices of the links that it was refined on
};

/// A motion refined on the links that agree with it, again until these stay the same; over the
/// motions of a basis only, if one is given. std::nullopt if fewer than min_inliers agree.
std::optional<SettledStep> settled_step(const StepRigs& rigs,
                                        const std::vector<TriangulatedLink>& links,
                                        const Pose& start,
                                        const StepOptions& options,
                                        const FloorBasis* within = nullptr);

/// MotionStep::other_motion of a step, by these links.
double other_motion(const Rig& rig,
                    std::span<const StereoCorner> from,
                    std::span<const StereoCorner> to,
                    std::span<const CornerLink> links,
                    const MotionStep& step,
                    const StepOptions& options);

std::vector<LinkedCorner> corners_at(const std::vector<TriangulatedLink>& links,
                                     const std::vector<int>& chosen);

}  // namespace vernier::localise::internal
