// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "calib/lens_models.h"

namespace vernier {

/// All camera models; they differ in the distortion of normalised coordinates.
using CameraModel = std::variant<Pinhole, Radial1, OpenCv4, OpenCv5, OpenCv8, Fisheye4>;

/// A camera: S = F(f, ax, ay, ox, oy, k) of Tina Memo 2017-001 with ay = 1 by definition, since (f,
/// ax, ay) together have an exact null direction.
///
///     u = f ax x_d + ox      x_d = distort(x / z, y / z; k)
///     v = f    y_d + oy
///
/// Camera frame: x right, y down, z forward. Pixel (0, 0) is the centre of the first pixel.
struct Camera {
  std::string name = "left";
  Eigen::Vector2i size_px{640, 480};  ///< width, height
  CameraModel model = Radial1{};
  Eigen::VectorXd parameters;  ///< f_px, ax, ox_px, oy_px, then the distortion k1 k2 p1 p2 k3 …

  double f_px() const { return core_parameter(0); }
  double ax() const { return core_parameter(1); }
  double ox_px() const { return core_parameter(2); }
  double oy_px() const { return core_parameter(3); }

  /// f_px, ax, ox_px or oy_px. Throws Error if the camera has no such parameter.
  double core_parameter(Eigen::Index index) const;
};

/// Number of parameters before the distortion in every model: f, ax, ox, oy.
inline constexpr int core_parameter_count = 4;

/// How many distortion coefficients any model has at most: the size of arrays that hold them.
inline constexpr int max_distortion_count =
    []<class... Models>(std::type_identity<std::variant<Models...>>) {
      return std::max({static_cast<int>(Models::distortion_names.size())...});
    }(std::type_identity<CameraModel>{});

/// The model called `name` (radial1, pinhole, opencv4, opencv5, opencv8, fisheye4). Throws Error
/// for any other name, listing these.
CameraModel camera_model(std::string_view name);
std::string_view model_name(const CameraModel& model);

/// Names of the free parameters in their order: f_px ax ox_px oy_px k1 …
std::vector<std::string> parameter_names(const CameraModel& model);
int parameter_count(const CameraModel& model);

/// Throws Error unless the camera has as many parameters as its model.
void check_parameters(const Camera& camera);

/// Derivatives of a projected pixel.
struct ProjectionJacobian {
  Eigen::Matrix<double, 2, 3> point;                ///< px / m
  Eigen::Matrix<double, 2, Eigen::Dynamic> camera;  ///< px / parameter, in the order of the names
};

/// Pixel of a point in the camera's frame (metres, z > 0). Like the functions below, throws Error
/// if the number of the camera's parameters is not that of its model.
Eigen::Vector2d project(const Camera& camera, const Eigen::Vector3d& point);
Eigen::Vector2d project(const Camera& camera,
                        const Eigen::Vector3d& point,
                        ProjectionJacobian& jacobian);

/// The same; std::nullopt for a point behind the camera or beyond the fold of its distortion, and
/// for a camera with f or ax not above 0.
std::optional<Eigen::Vector2d> try_project(const Camera& camera, const Eigen::Vector3d& point);

/// The ray (x / z, y / z, 1) that projects to `pixel`, by Newton's method on the distortion, to
/// rounding. Throws Error if the model cannot be inverted there (beyond its fold).
Eigen::Vector3d unproject(const Camera& camera, const Eigen::Vector2d& pixel);

/// The same; std::nullopt if the model cannot be inverted there.
std::optional<Eigen::Vector3d> try_unproject(const Camera& camera, const Eigen::Vector2d& pixel);

/// Whether the pixel lies in the image: within half a pixel of the outermost pixel centres.
bool in_image(const Camera& camera, const Eigen::Vector2d& pixel);

}  // namespace vernier
