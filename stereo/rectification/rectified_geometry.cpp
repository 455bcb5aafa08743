// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/rectification.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <variant>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "stereo/rectification/raw_pixels.h"

namespace vernier::stereo {

using namespace internal;

namespace {

constexpr int blank_columns = 40, blank_rows = 30;  // grid on which blank pixels are counted
constexpr int bisections = 16;                      // of the focal length, to 1e-5 of it
constexpr double nearly_mean = 0.97;                // relative to the mean focal length

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

/// The size of a camera's images, its sides exchanged if rectification turns them by about a
/// quarter, as those of cameras one above the other.
Eigen::Vector2i turned_size_px(const Camera& camera, const Eigen::Matrix3d& R_rectified_camera) {
  const bool is_upright = std::abs(R_rectified_camera(0, 0)) >= std::abs(R_rectified_camera(0, 1));
  return is_upright ? camera.size_px : camera.size_px.reverse();
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

}  // namespace

RectifiedGeometry rectified_geometry(const Rig& rig, const RectifiedGeometryOptions& options) {
  check(options);
  RectifiedGeometry geometry;
  geometry.turn = rectification(rig);
  geometry.baseline_m = rig.T_camera_first[1].t.norm();
  const bool sized = options.size_px[0] > 0;
  const auto size_px = [&](int camera) -> Eigen::Vector2i {
    return sized ? options.size_px : turned_size_px(rig.cameras[camera], turn_of(geometry, camera));
  };
  geometry.size_px = size_px(0);
  std::array<Eigen::Vector2d, 2> middles_px;
  for (int i = 0; i < 2; ++i) {
    middles_px[i] = 0.5 * (size_px(i) - Eigen::Vector2i::Ones()).cast<double>();
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
  const auto ray = try_unproject(camera_of_pair(rig, camera), raw_px);
  if (!ray) return std::nullopt;
  const Eigen::Vector3d x = turn_of(geometry, camera) * *ray;
  if (!(x.z() > 0)) return std::nullopt;
  return geometry.f_px * x.head<2>() / x.z() + geometry.centre_px;
}

}  // namespace vernier::stereo
