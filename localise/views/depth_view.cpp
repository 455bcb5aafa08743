// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/views/depth_view.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "calib/base/all_within.h"
#include "calib/camera.h"
#include "calib/camera/opencv_intrinsics.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "localise/place.h"
#include "localise/views/depth_steps.h"
#include "localise/views/edge_depths.h"
#include "stereo/canny_edges.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/grey_levels.h"
#include "stereo/image/depth_image.h"
#include "stereo/reconstruction/segment_disparity.h"
#include "stereo/reconstruction/space_segments.h"
#include "stereo/segment.h"

namespace vernier::localise::internal {

using namespace vernier::internal;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Both ends in space with their covariance.
MeasuredSegment placed(const SegmentDisparity& s, const OpenCvIntrinsics& k) {
  MeasuredSegment result;
  result.status = status_in_space(s);
  if (result.status != SegmentStatus::placed) return result;
  Eigen::Matrix<double, 6, 6> J = Eigen::Matrix<double, 6, 6>::Zero();
  for (int end = 0; end < 2; ++end) {
    const Vector2d& px = end == 0 ? s.left_px.a_px : s.left_px.b_px;
    const double d = end == 0 ? s.a_disparity_px : s.b_disparity_px;
    const double z = k.fx_px / d;
    const Vector3d p(z * (px.x() - k.cx_px) / k.fx_px, z * (px.y() - k.cy_px) / k.fy_px, z);
    J(3 * end, 2 * end) = z / k.fx_px;
    J(3 * end + 1, 2 * end + 1) = z / k.fy_px;
    J.block<3, 1>(3 * end, 4 + end) = -p / d;
    (end == 0 ? result.segment.a_m : result.segment.b_m) = p;
  }
  const SpaceSegmentOptions usual;
  state_independent_error(result, J, s.covariance_px2, usual);
  judge_linearity(result, usual);
  return result;
}

void check(const Camera& camera,
           const GreyLevels& image,
           const DepthImage& depth,
           const DepthNoise& noise) {
  if (!std::holds_alternative<Pinhole>(camera.model)) {
    throw Error("camera \"" + camera.name + "\"", "has a lens with distortion",
                "give undistorted images and depths, and their pinhole camera");
  }
  for (const auto& [width, height, what] :
       {std::tuple{image.width_px, image.height_px, "image"},
        std::tuple{depth.width_px, depth.height_px, "depth map"}}) {
    if (Eigen::Vector2i(width, height) == camera.size_px) continue;
    throw Error("camera \"" + camera.name + "\"",
                fmt::format("is of {}x{} px, the {} of {}x{}", camera.size_px[0], camera.size_px[1],
                            what, width, height),
                "give an aligned depth map of the image's size, and its camera");
  }
  if (!(noise.floor_m > 0 && noise.per_m2 >= 0)) {
    throw Error("depth noise", "is not above 0", "use e.g. 0.01 m and 0.0015 / m");
  }
}

/// A pixel of a camera in the level one; nothing beyond 80 degrees from its axis.
std::optional<Vector2d> level_pixel(const OpenCvIntrinsics& k,
                                    const Matrix3d& R,
                                    const Vector2d& px) {
  const Vector3d ray =
      (R * Vector3d((px.x() - k.cx_px) / k.fx_px, (px.y() - k.cy_px) / k.fy_px, 1)).normalized();
  constexpr double cosine = 0.1736;
  if (ray.z() < cosine) return {};
  return Vector2d(k.cx_px + k.fx_px * ray.x() / ray.z(), k.cy_px + k.fy_px * ray.y() / ray.z());
}

}  // namespace

DepthSegments depth_segments(const Camera& camera,
                             const GreyLevels& image,
                             const DepthImage& depth,
                             const DepthNoise& noise) {
  check(camera, image, depth, noise);
  const OpenCvIntrinsics k = opencv_intrinsics(camera);
  const std::vector<EdgePoint> edges = canny_edges(image);
  SegmentDisparityOptions how;
  how.min_angle_rad = 0;  // depths are known along rows too
  how.floor_px = k.fx_px * noise.per_m2;
  how.moved_alike = 0;
  DepthSegments segments;
  segments.steps = steps_at_edges(edges, depth);
  for (const SegmentDisparity& s : segment_disparities(
           edges, edge_segments(edges), inverse_depths(edges, depth, k.fx_px, noise), how)) {
    segments.in_space.push_back(placed(s, k));
    segments.image.push_back(s.left_px);
  }
  return segments;
}

LevelPose level_pose(const Pose& T_world_camera,
                     int up_axis,
                     int up_sign,
                     const std::string& place) {
  Matrix3d R_floor_world = Matrix3d::Zero();  // z up
  R_floor_world(0, (up_axis + 1) % 3) = 1;
  R_floor_world(1, (up_axis + 2) % 3) = up_sign;
  R_floor_world(2, up_axis) = up_sign;
  const Matrix3d R = R_floor_world * T_world_camera.R;
  const Vector3d t = R_floor_world * T_world_camera.t, axis = R.col(2);
  if (!(axis.head<2>().norm() > 1e-3)) {
    throw Error(place, "the camera looks straight up or down", "leave the image out");
  }
  LevelPose level;
  level.pose = {t.x(), t.y(), std::atan2(axis.y(), axis.x())};
  level.height_m = t.z();
  // of the level camera: x right, y down, z along the heading
  const double c = std::cos(level.pose.heading_rad), s = std::sin(level.pose.heading_rad);
  Matrix3d R_floor_level;
  R_floor_level << s, 0, c, -c, 0, s, 0, -1, 0;
  level.R_level_camera = R_floor_level.transpose() * R;
  return level;
}

PlaceView level_view(const Camera& camera,
                     const DepthSegments& segments,
                     const Matrix3d& R_level_camera,
                     double height_m,
                     const PlaceLineOptions& options) {
  const OpenCvIntrinsics k = opencv_intrinsics(camera);
  std::vector<SpaceSegment> in_space;
  std::vector<StereoSegment> in_image;
  std::vector<ImageSegment> monocular;
  for (std::size_t i = 0; i < segments.image.size(); ++i) {
    const auto a = level_pixel(k, R_level_camera, segments.image[i].a_px);
    const auto b = level_pixel(k, R_level_camera, segments.image[i].b_px);
    if (!a || !b) continue;
    const MeasuredSegment& s = segments.in_space[i];
    if (s.status != SegmentStatus::placed) {
      monocular.push_back({*a, *b});
      continue;
    }
    SpaceSegment level = s.segment;
    level.a_m = R_level_camera * s.segment.a_m;
    level.b_m = R_level_camera * s.segment.b_m;
    const int farther = level.a_m.z() > level.b_m.z() ? 0 : 3;
    const Matrix3d C = R_level_camera * s.independent_m2.block<3, 3>(farther, farther) *
                       R_level_camera.transpose();
    level.depth_sigma_m = std::sqrt(C(2, 2));
    in_space.push_back(level);
    in_image.push_back({{*a, *b}, {*a, *b}, 0});
  }
  PlaceView view = select_lines(in_space, in_image, {height_m, 0}, options);
  view.monocular_lines = std::move(monocular);
  // what a file of views takes for pixels
  const double most_px = 2.0 * camera.size_px.maxCoeff();
  const auto far_off = [&](const ImageSegment& s) {
    return !all_within(s.a_px, most_px) || !all_within(s.b_px, most_px);
  };
  std::erase_if(view.image_lines, far_off);
  std::erase_if(view.monocular_lines, far_off);
  return view;
}

}  // namespace vernier::localise::internal
