// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/camera.h"
#include "calib/pose.h"
#include "localise/place.h"
#include "localise/views/depth_steps.h"
#include "localise/views/edge_depths.h"
#include "stereo/grey_levels.h"
#include "stereo/image/depth_image.h"
#include "stereo/reconstruction/space_segments.h"
#include "stereo/segment.h"

namespace vernier::localise::internal {

struct DepthViewOptions {
  DepthNoise noise;
  PlaceLineOptions lines;
};

/// Segments of an image, those with depths in space: metres, in the camera's frame, with the
/// covariance of both ends (independent_m2). `image[i]` is that of segment i. `steps` tells whether
/// the depth map is the image's.
struct DepthSegments {
  std::vector<stereo::internal::MeasuredSegment> in_space;
  std::vector<stereo::ImageSegment> image;
  StepsAtEdges steps;
};

/// Straight edges of an image with the depths of an aligned map (edge_depths.h). A straight line in
/// space has an inverse depth that is linear along its image, so the rest is as for disparities
/// (stereo/reconstruction/segment_disparity.h), with d = f / z: consensus along the edge, parts
/// where surfaces change, covariance. Depth errors are not correlated with the place of the edge.
/// Throws Error unless the camera is a pinhole and both images have its size.
DepthSegments depth_segments(const Camera& camera,
                             const stereo::GreyLevels& image,
                             const stereo::internal::DepthImage& depth,
                             const DepthNoise& noise = {});

/// Where a camera stands on the floor, and how it is turned against a level one that looks the same
/// way: x_level = R_level_camera x_camera.
struct LevelPose {
  Pose2D pose;
  double height_m = 0;  ///< along `up`, from the world's origin
  Eigen::Matrix3d R_level_camera;
};

/// The level pose of a camera in a world whose axis `up_axis` (0 to 2) points up, or down where
/// `up_sign` is −1. The floor's x is the axis after the next one, its y the next after that, so
/// that both and up are a right-handed frame (x y z for z up, z x y for y up; y down: z −x −y).
/// Throws Error(`place`) for a camera that looks straight up or down: it has no heading.
LevelPose level_pose(const Pose& T_world_camera,
                     int up_axis,
                     int up_sign,
                     const std::string& place);

/// The view of a level camera at the same place: lines in space and in its image, as they are seen
/// once roll and pitch are known, as from gravity. The camera is a pinhole of the same focal
/// lengths and centre; lines beyond 80° from its axis are left out, and image lines further off
/// than twice its larger side. Lines without a depth are monocular. The view has no rig.
PlaceView level_view(const Camera& camera,
                     const DepthSegments& segments,
                     const Eigen::Matrix3d& R_level_camera,
                     double height_m,
                     const PlaceLineOptions& options = {});

}  // namespace vernier::localise::internal
