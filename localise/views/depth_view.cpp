// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/views/depth_view.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "calib/camera.h"
#include "calib/camera/opencv_intrinsics.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "localise/place.h"
#include "stereo/canny_edges.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/grey_levels.h"
#include "stereo/image/depth_image.h"
#include "stereo/matcher.h"
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

constexpr int farthest_px = 5;       // across an edge, where depths are read
constexpr int beyond_own_px = 3;     // from where on an edge is another one
constexpr int least_depths = 3;      // of a side
constexpr int across_hole_px = 40;   // where a side without depths is looked beyond
constexpr double off_sigma = 3;      // a depth farther from the plane is of another surface
constexpr double step_share = 0.02;  // of the depth: a smaller difference of sides is no step

double sigma_of(double z_m, const DepthNoise& noise) {
  return std::hypot(noise.floor_m, noise.per_m2 * z_m * z_m);
}

/// A depth at an edge, and the variance of its noise as a multiple of one pixel's.
struct EdgeDepth {
  double z_m, noise;
};

/// A pixel beside an edge: its distance from it, and its inverse depth.
struct Beside {
  double across_px, inverse_m;
};

/// The pixels that edges touch: those less than one away, along x and y, from a point.
class EdgePixels {
 public:
  EdgePixels(const std::vector<EdgePoint>& edges, int width_px, int height_px)
      : width_px_(width_px),
        height_px_(height_px),
        is_edge_(static_cast<std::size_t>(width_px) * height_px, false) {
    for (const EdgePoint& e : edges) {
      for (const float x : {std::floor(e.pixel_px.x()), std::ceil(e.pixel_px.x())}) {
        for (const float y : {std::floor(e.pixel_px.y()), std::ceil(e.pixel_px.y())}) {
          const Eigen::Vector2i p(static_cast<int>(x), static_cast<int>(y));
          if (is_inside(p)) is_edge_[index(p)] = true;
        }
      }
    }
  }

  bool is_inside(const Eigen::Vector2i& p) const {
    return p.x() >= 0 && p.y() >= 0 && p.x() < width_px_ && p.y() < height_px_;
  }
  bool is_edge(const Eigen::Vector2i& p) const { return is_edge_[index(p)]; }

 private:
  std::size_t index(const Eigen::Vector2i& p) const {
    return static_cast<std::size_t>(p.y()) * width_px_ + p.x();
  }

  int width_px_, height_px_;
  std::vector<bool> is_edge_;
};

/// A depth map and the edges of its image.
struct EdgesWithDepth {
  const DepthImage& depth;
  const EdgePixels& edges;
  const DepthNoise& noise;
};

Eigen::Vector2i pixel_beside(const EdgePoint& e, float side, int distance_px) {
  const Eigen::Vector2f p = e.pixel_px + side * static_cast<float>(distance_px) * e.normal;
  return {static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))};
}

/// Those of known depth on one side of an edge point, up to the next edge if that leaves enough,
/// the nearest first.
std::vector<Beside> pixels_beside(const EdgesWithDepth& view, const EdgePoint& e, float side) {
  std::vector<Beside> found;
  Eigen::Vector2i last(-1, -1);
  for (int k = 1; k <= farthest_px; ++k) {
    const Eigen::Vector2i at = pixel_beside(e, side, k);
    if (at == last || !view.edges.is_inside(at)) continue;
    const bool is_other_edge = k >= beyond_own_px && view.edges.is_edge(at);
    if (is_other_edge && static_cast<int>(found.size()) >= least_depths) break;
    last = at;
    const float across = side * e.normal.dot(at.cast<float>() - e.pixel_px);
    if (const float z = view.depth(at.x(), at.y()); z > 0) found.push_back({across, 1.0 / z});
  }
  return found;
}

/// The nearest of the first depths known on one side, however far and beyond other edges; nothing
/// if there are none up to `across_hole_px`.
std::optional<double> nearest_beyond(const EdgesWithDepth& view, const EdgePoint& e, float side) {
  constexpr int enough = 3;
  std::optional<double> nearest;
  int known = 0;
  for (int k = 1; k <= across_hole_px && known < enough; ++k) {
    const Eigen::Vector2i at = pixel_beside(e, side, k);
    if (!view.edges.is_inside(at)) break;
    const float z = view.depth(at.x(), at.y());
    if (!(z > 0)) continue;
    nearest = std::min<double>(z, nearest.value_or(z));
    ++known;
  }
  return nearest;
}

EdgeDepth median(const std::vector<Beside>& pixels) {
  std::vector<double> inverse_m;
  for (const Beside& p : pixels) inverse_m.push_back(p.inverse_m);
  const auto middle = inverse_m.begin() + static_cast<long>((inverse_m.size() - 1) / 2);
  std::nth_element(inverse_m.begin(), middle, inverse_m.end());
  return {1 / *middle, 1};
}

/// The depth at the edge of a plane through the pixels, whose inverse depth is linear in the image;
/// nothing if they lie on none.
std::optional<EdgeDepth> in_plane(std::span<const Beside> pixels, const DepthNoise& noise) {
  if (static_cast<int>(pixels.size()) < least_depths) return {};
  const double n = static_cast<double>(pixels.size());
  double x = 0, y = 0, xx = 0, xy = 0;
  for (const Beside& p : pixels) x += p.across_px / n, y += p.inverse_m / n;
  for (const Beside& p : pixels) {
    xx += (p.across_px - x) * (p.across_px - x);
    xy += (p.across_px - x) * (p.inverse_m - y);
  }
  const double slope = xy / xx, at_edge = y - slope * x;
  const double sigma = y * y * sigma_of(1 / y, noise);
  for (const Beside& p : pixels) {
    if (std::abs(p.inverse_m - at_edge - slope * p.across_px) > off_sigma * sigma) return {};
  }
  if (!(at_edge > 0)) return {};
  return EdgeDepth{1 / at_edge, 1 / n + x * x / xx};
}

/// The depth of one side at an edge point; nothing if too few are known.
std::optional<EdgeDepth> depth_beside(const EdgesWithDepth& view, const EdgePoint& e, float side) {
  const std::vector<Beside> pixels = pixels_beside(view, e, side);
  if (static_cast<int>(pixels.size()) < least_depths) return {};
  if (const auto all = in_plane(pixels, view.noise)) return all;
  // the nearest may hold both sides
  if (const auto others = in_plane(std::span(pixels).subspan(1), view.noise)) return others;
  return median(pixels);
}

/// Whether the depths of both sides of an edge are of two surfaces.
bool is_step(const EdgeDepth& nearer, const EdgeDepth& farther, const DepthNoise& noise) {
  const DepthNoise of_both{noise.floor_m * std::sqrt(nearer.noise + farther.noise),
                           noise.per_m2 * std::numbers::sqrt2};
  return farther.z_m - nearer.z_m >
         std::max(off_sigma * sigma_of(nearer.z_m, of_both), step_share * nearer.z_m);
}

/// The depth of an edge point: the nearer one at a step. Where one side is not known, the other is
/// taken only if what is beyond is known not to be nearer: a surface that gives no depth, as a dark
/// one, would else get that of its background.
std::optional<EdgeDepth> depth_at(const EdgesWithDepth& view, const EdgePoint& e) {
  const auto dark = depth_beside(view, e, -1), bright = depth_beside(view, e, 1);
  if (!dark && !bright) return {};
  if (!dark || !bright) {
    const EdgeDepth known = dark ? *dark : *bright;
    const auto beyond = nearest_beyond(view, e, dark ? 1 : -1);
    if (!beyond || is_step({*beyond, 1}, known, view.noise)) return {};
    return known;
  }
  const auto [nearer, farther] =
      dark->z_m < bright->z_m ? std::pair(*dark, *bright) : std::pair(*bright, *dark);
  if (is_step(nearer, farther, view.noise)) return nearer;
  return EdgeDepth{(dark->z_m + bright->z_m) / 2, (dark->noise + bright->noise) / 4};
}

/// d = f / z at the edge points. Noise is not taken for less than a pixel's: that of neighbours is
/// alike in real maps.
std::vector<EdgeDisparity> inverse_depths(const std::vector<EdgePoint>& edges,
                                          const DepthImage& depth,
                                          double f_px,
                                          const DepthNoise& noise) {
  const EdgePixels pixels(edges, depth.width_px, depth.height_px);
  const EdgesWithDepth view{depth, pixels, noise};
  std::vector<EdgeDisparity> found(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    found[i].disparity_px = std::numeric_limits<float>::quiet_NaN();
    const std::optional<EdgeDepth> at = depth_at(view, edges[i]);
    if (!at) continue;
    const DepthNoise here{noise.floor_m * std::sqrt(std::max(1.0, at->noise)), noise.per_m2};
    found[i].disparity_px = static_cast<float>(f_px / at->z_m);
    found[i].sigma_px = static_cast<float>(f_px / (at->z_m * at->z_m) * sigma_of(at->z_m, here));
    found[i].confidence = 1;
  }
  return found;
}

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
    return std::max(s.a_px.cwiseAbs().maxCoeff(), s.b_px.cwiseAbs().maxCoeff()) > most_px;
  };
  std::erase_if(view.image_lines, far_off);
  std::erase_if(view.monocular_lines, far_off);
  return view;
}

}  // namespace vernier::localise::internal
