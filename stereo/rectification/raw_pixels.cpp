// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/rectification/raw_pixels.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "stereo/rectification.h"

namespace vernier::stereo::internal {
namespace {

constexpr int border_steps = 40;        // along each side of an image
constexpr double border_margin = 0.98;  // allows for the bend of the border between them
constexpr double same_ray = 1e-6;       // tolerance of identical rays

/// Smallest norm of the rays (x / z, y / z) of a camera's border pixels; 0 if one has none or the
/// optical axis is not in the image.
double min_border_radius(const Camera& camera) {
  const Eigen::Vector2d last = (camera.size_px - Eigen::Vector2i::Ones()).cast<double>();
  if (!in_image(camera, {camera.ox_px(), camera.oy_px()})) return 0;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= border_steps; ++i) {
    const double t = static_cast<double>(i) / border_steps;
    for (const Eigen::Vector2d& pixel :
         {Eigen::Vector2d(t * last.x(), 0), Eigen::Vector2d(t * last.x(), last.y()),
          Eigen::Vector2d(0, t * last.y()), Eigen::Vector2d(last.x(), t * last.y())}) {
      const auto ray = try_unproject(camera, pixel);
      if (!ray) return 0;
      least = std::min(least, ray->head<2>().norm());
    }
  }
  return border_margin * least;
}

}  // namespace

const Eigen::Matrix3d& turn_of(const RectifiedGeometry& geometry, int camera) {
  return camera == 0 ? geometry.turn.R_rectified_left : geometry.turn.R_rectified_right;
}

const Camera& camera_of_pair(const Rig& rig, int camera) {
  if ((camera == 0 || camera == 1) && rig.cameras.size() > static_cast<std::size_t>(camera)) {
    return rig.cameras[static_cast<std::size_t>(camera)];
  }
  throw Error("rectification", "the pair has no camera " + std::to_string(camera),
              "give 0 for the left one or 1 for the right one");
}

RawPixels::RawPixels(const Rig& rig, const RectifiedGeometry& geometry, int camera)
    : camera_(camera_of_pair(rig, camera)),
      R_camera_rectified_(turn_of(geometry, camera).transpose()),
      f_px_(geometry.f_px),
      centre_px_(geometry.centre_px),
      sure_radius_(min_border_radius(camera_)) {}

std::optional<Eigen::Vector2d> RawPixels::at(const Eigen::Vector2d& rectified_px) const {
  const Eigen::Vector2d x = (rectified_px - centre_px_) / f_px_;
  const Eigen::Vector3d ray = R_camera_rectified_ * Eigen::Vector3d(x[0], x[1], 1);
  if (!(ray.z() > 0)) return std::nullopt;
  const Eigen::Vector2d pixel = project(camera_, ray);
  if (ray.head<2>().norm() < sure_radius_ * ray.z()) return pixel;
  // Beyond the fold of a distortion the pixel belongs to another ray.
  const auto back = try_unproject(camera_, pixel);
  if (!back) return std::nullopt;
  const Eigen::Vector2d apart = back->head<2>() - ray.head<2>() / ray.z();
  if (!(apart.norm() < same_ray * (1 + back->norm()))) return std::nullopt;
  return pixel;
}

std::optional<Eigen::Vector2d> RawPixels::in_image_at(const Eigen::Vector2d& rectified_px) const {
  const auto pixel = at(rectified_px);
  return pixel && in_image(camera_, *pixel) ? pixel : std::nullopt;
}

}  // namespace vernier::stereo::internal
