// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/odometry.h"
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
};

/// The links whose pixels have points that project to them within the gate, at both moments.
std::vector<TriangulatedLink> triangulated_links(const Rig& rig,
                                                 std::span<const StereoCorner> from,
                                                 std::span<const StereoCorner> to,
                                                 std::span<const CornerLink> links,
                                                 const StepOptions& options);

/// The motion on which most links agree; std::nullopt if none of three links is found.
std::optional<Pose> consensus(const Rig& rig,
                              const std::vector<TriangulatedLink>& links,
                              const StepOptions& options);

/// Indices of the links within the gate of a motion.
std::vector<int> agreeing_links(const Rig& rig,
                                const std::vector<TriangulatedLink>& links,
                                const Pose& T_from_to,
                                double gate_probability);

}  // namespace vernier::localise::internal
