// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/rectified_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <variant>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/fisheye4.h"
#include "calib/pose.h"
#include "calib/radial1.h"
#include "calib/rig.h"
#include "stereo/rectification.h"

namespace vernier::stereo {
namespace {

constexpr int blank_columns = 40, blank_rows = 30;  // grid on which blank pixels are counted
constexpr int bisections = 16;                      // of the focal length, to 1e-5 of it
constexpr double nearly_mean = 0.97;                // relative to the mean focal length
constexpr int border_steps = 40;                    // along each side of an image
constexpr double border_margin = 0.98;  // allows for the bend of the border between them
constexpr double same_ray = 1e-6;       // tolerance of identical rays

void check(const RectifiedGeometryOptions& o) {
  const bool size = (o.size_px.array() == 0).all() || (o.size_px.array() > 0).all();
  if (size && o.f_px >= 0 && std::isfinite(o.f_px) && o.max_blank >= 0 && o.min_zoom > 0 &&
      o.max_zoom >= o.min_zoom && std::isfinite(o.max_zoom)) {
    return;
  }
  throw Error("rectification",
              fmt::format("invalid options: size {}x{} px, f {} px, max_blank {}, zoom {} to {}",
                          o.size_px[0], o.size_px[1], o.f_px, o.max_blank, o.min_zoom, o.max_zoom),
              "use sizes and focal lengths above 0, or 0 for automatic");
}

/// Position of the image centre on the rectified camera's plane z = 1; its optical axis if the
/// model cannot be inverted there.
Eigen::Vector2d rectified_middle(const Camera& camera, const Eigen::Matrix3d& R_rectified_camera) {
  const Eigen::Vector2d middle = 0.5 * (camera.size_px - Eigen::Vector2i::Ones()).cast<double>();
  const Eigen::Vector3d ray =
      R_rectified_camera * try_unproject(camera, middle).value_or(Eigen::Vector3d::UnitZ());
  return ray.head<2>() / ray.z();
}

const Eigen::Matrix3d& turn_of(const RectifiedGeometry& geometry, int camera) {
  return camera == 0 ? geometry.turn.R_rectified_left : geometry.turn.R_rectified_right;
}

/// At this focal length; `middle` is where the mean of both cameras' image centres goes.
RectifiedGeometry at_focal_length(const Rig& rig,
                                  RectifiedGeometry geometry,
                                  const std::array<Eigen::Vector2d, 2>& middles_px,
                                  double f_px) {
  geometry.f_px = f_px;
  geometry.centre_px.setZero();
  for (int i = 0; i < 2; ++i) {
    geometry.centre_px +=
        0.5 * (middles_px[i] - f_px * rectified_middle(rig.cameras[i], turn_of(geometry, i)));
  }
  return geometry;
}

/// Fraction of pixels without a source, the larger of both images.
double blank_share(const Rig& rig, const RectifiedGeometry& geometry) {
  int most = 0;
  for (int camera = 0; camera < 2; ++camera) {
    const RawPixels raw(rig, geometry, camera);
    int blank = 0;
    for (int j = 0; j < blank_rows; ++j) {
      for (int i = 0; i < blank_columns; ++i) {
        const Eigen::Vector2d at((geometry.size_px[0] - 1.0) * i / (blank_columns - 1),
                                 (geometry.size_px[1] - 1.0) * j / (blank_rows - 1));
        blank += !raw.in_image_at(at);
      }
    }
    most = std::max(most, blank);
  }
  return static_cast<double>(most) / (blank_columns * blank_rows);
}

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

RawPixels::RawPixels(const Rig& rig, const RectifiedGeometry& geometry, int camera)
    : camera_(rig.cameras.at(static_cast<std::size_t>(camera))),
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

RectifiedGeometry rectified_geometry(const Rig& rig, const RectifiedGeometryOptions& options) {
  check(options);
  RectifiedGeometry geometry;
  geometry.turn = rectification(rig);
  geometry.baseline_m = rig.T_camera_first[1].t.norm();
  const bool sized = options.size_px[0] > 0;
  geometry.size_px = sized ? options.size_px : rig.cameras[0].size_px;
  std::array<Eigen::Vector2d, 2> middles_px;
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2i size = sized ? options.size_px : rig.cameras[i].size_px;
    middles_px[i] = 0.5 * (size - Eigen::Vector2i::Ones()).cast<double>();
  }
  const auto at = [&](double f_px) { return at_focal_length(rig, geometry, middles_px, f_px); };
  if (options.f_px > 0) return at(options.f_px);

  const double mean = 0.5 * (rig.cameras[0].f_px() + rig.cameras[1].f_px());
  double wide = options.min_zoom * mean, narrow = options.max_zoom * mean;
  const auto is_full = [&](double f) { return blank_share(rig, at(f)) <= options.max_blank; };
  if (is_full(mean) && nearly_mean * mean > wide && !is_full(nearly_mean * mean)) return at(mean);
  if (is_full(wide)) return at(wide);
  if (!is_full(narrow)) return at(narrow);
  for (int i = 0; i < bisections; ++i) {
    const double middle = 0.5 * (wide + narrow);
    (is_full(middle) ? narrow : wide) = middle;
  }
  return at(narrow);
}

std::optional<RectifiedGeometry> geometry_of_rectified_rig(const Rig& rig) {
  if (rig.cameras.size() != 2) return std::nullopt;
  const Camera &left = rig.cameras[0], &right = rig.cameras[1];
  for (const Camera& camera : rig.cameras) check_parameters(camera);
  for (const Camera& camera : rig.cameras) {
    const auto lens = camera.parameters.tail(camera.parameters.size() - core_parameter_count);
    const bool pinhole = !std::holds_alternative<Fisheye4>(camera.model) && lens.isZero(0);
    if (!pinhole || camera.ax() != 1) return std::nullopt;
  }
  const Pose& T = rig.T_camera_first[1];
  constexpr double rounding = 1e-9;
  if (left.size_px != right.size_px || !T.R.isIdentity(rounding) || !(T.t.x() < 0) ||
      T.t.tail<2>().norm() > rounding * T.t.norm() ||
      std::abs(left.f_px() - right.f_px()) > rounding * left.f_px() ||
      std::abs(left.oy_px() - right.oy_px()) > rounding * left.f_px()) {
    return std::nullopt;
  }
  RectifiedGeometry geometry;
  geometry.turn = {Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity()};
  geometry.f_px = left.f_px();
  geometry.centre_px = {left.ox_px(), left.oy_px()};
  geometry.baseline_m = -T.t.x();
  geometry.size_px = left.size_px;
  return geometry;
}

Rig rectified_rig(const Rig& rig, const RectifiedGeometry& geometry) {
  Rig rectified;
  for (const Camera& raw : rig.cameras) {
    Camera camera;
    camera.name = raw.name;
    camera.size_px = geometry.size_px;
    camera.model = Pinhole{};
    camera.parameters =
        Eigen::Vector4d(geometry.f_px, 1, geometry.centre_px[0], geometry.centre_px[1]);
    rectified.cameras.push_back(camera);
  }
  rectified.T_camera_first = {Pose{},
                              Pose{Eigen::Matrix3d::Identity(), {-geometry.baseline_m, 0, 0}}};
  return rectified;
}

std::optional<Eigen::Vector2d> raw_pixel(const Rig& rig,
                                         const RectifiedGeometry& geometry,
                                         int camera,
                                         const Eigen::Vector2d& rectified_px) {
  return RawPixels(rig, geometry, camera).at(rectified_px);
}

std::optional<Eigen::Vector2d> rectified_pixel(const Rig& rig,
                                               const RectifiedGeometry& geometry,
                                               int camera,
                                               const Eigen::Vector2d& raw_px) {
  const auto ray = try_unproject(rig.cameras.at(static_cast<std::size_t>(camera)), raw_px);
  if (!ray) return std::nullopt;
  const Eigen::Vector3d x = turn_of(geometry, camera) * *ray;
  if (!(x.z() > 0)) return std::nullopt;
  return geometry.f_px * x.head<2>() / x.z() + geometry.centre_px;
}

}  // namespace vernier::stereo
