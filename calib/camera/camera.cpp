// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/camera.h"

#include <Eigen/LU>
#include <cmath>
#include <cstddef>

#include "calib/base/shown_text.h"
#include "calib/error.h"

namespace vernier {
namespace {

template <std::size_t I = 0>
CameraModel find_model(std::string_view name) {
  if constexpr (I == std::variant_size_v<CameraModel>) {
    throw Error("camera model " + internal::in_quotes(name), "unknown model",
                "supported: radial1, pinhole, opencv4, opencv5, opencv8, fisheye4");
  } else {
    using Model = std::variant_alternative_t<I, CameraModel>;
    if (Model::name == name) return Model{};
    return find_model<I + 1>(name);
  }
}

[[noreturn]] void throw_wrong_parameters(const Camera& camera) {
  throw Error("camera \"" + camera.name + "\"",
              "it has " + std::to_string(camera.parameters.size()) + " parameters, not " +
                  std::to_string(parameter_count(camera.model)),
              "give f_px, ax, ox_px, oy_px, then the model's distortion");
}

/// The camera's parameters, with the number of parameters of `Model`.
template <class Model>
const double* parameters_of(const Camera& camera) {
  constexpr auto count =
      core_parameter_count + static_cast<Eigen::Index>(Model::distortion_names.size());
  if (camera.parameters.size() != count) throw_wrong_parameters(camera);
  return camera.parameters.data();
}

}  // namespace

double Camera::core_parameter(Eigen::Index index) const {
  if (index >= parameters.size()) throw_wrong_parameters(*this);
  return parameters[index];
}

void check_parameters(const Camera& camera) {
  if (camera.parameters.size() != parameter_count(camera.model)) throw_wrong_parameters(camera);
}

CameraModel camera_model(std::string_view name) { return find_model(name); }

std::string_view model_name(const CameraModel& model) {
  return std::visit([](auto m) { return decltype(m)::name; }, model);
}

std::vector<std::string> parameter_names(const CameraModel& model) {
  std::vector<std::string> names{"f_px", "ax", "ox_px", "oy_px"};
  std::visit(
      [&](auto m) {
        names.insert(names.end(), m.distortion_names.begin(), m.distortion_names.end());
      },
      model);
  return names;
}

int parameter_count(const CameraModel& model) {
  return core_parameter_count +
         std::visit([](auto m) { return static_cast<int>(m.distortion_names.size()); }, model);
}

Eigen::Vector2d project(const Camera& camera, const Eigen::Vector3d& point) {
  const Eigen::Vector2d x = point.head<2>() / point.z();
  return std::visit(
      [&](auto m) -> Eigen::Vector2d {
        const double* a = parameters_of<decltype(m)>(camera);
        const Eigen::Vector2d x_d = m.distort(x, a + core_parameter_count).x;
        return {a[0] * a[1] * x_d[0] + a[2], a[0] * x_d[1] + a[3]};
      },
      camera.model);
}

Eigen::Vector2d project(const Camera& camera,
                        const Eigen::Vector3d& point,
                        ProjectionJacobian& jacobian) {
  const double inverse_z = 1 / point.z();
  const Eigen::Vector2d x = point.head<2>() * inverse_z;
  return std::visit(
      [&](auto m) -> Eigen::Vector2d {
        const double* a = parameters_of<decltype(m)>(camera);
        const double fx = a[0] * a[1], fy = a[0];
        const auto d = m.distort(x, a + core_parameter_count);
        jacobian.camera.resize(2, camera.parameters.size());
        jacobian.camera.template leftCols<core_parameter_count>() << a[1] * d.x[0], fy * d.x[0], 1,
            0, d.x[1], 0, 0, 1;
        const int n = static_cast<int>(m.distortion_names.size());
        jacobian.camera.row(0).tail(n) = fx * d.by_k.row(0);
        jacobian.camera.row(1).tail(n) = fy * d.by_k.row(1);

        Eigen::Matrix<double, 2, 3> x_by_point;
        x_by_point << inverse_z, 0, -x[0] * inverse_z, 0, inverse_z, -x[1] * inverse_z;
        jacobian.point = d.by_x * x_by_point;
        jacobian.point.row(0) *= fx;
        jacobian.point.row(1) *= fy;
        return {fx * d.x[0] + a[2], fy * d.x[1] + a[3]};
      },
      camera.model);
}

std::optional<Eigen::Vector2d> try_project(const Camera& camera, const Eigen::Vector3d& point) {
  if (!(camera.f_px() > 0 && camera.ax() > 0 && point.z() > 0)) return std::nullopt;
  ProjectionJacobian J;
  const Eigen::Vector2d pixel = project(camera, point, J);
  const Eigen::Matrix2d by_x = J.point.leftCols<2>();
  if (!pixel.allFinite() || !(by_x.determinant() > 0 && by_x.trace() > 0)) return std::nullopt;
  return pixel;
}

std::optional<Eigen::Vector3d> try_unproject(const Camera& camera, const Eigen::Vector2d& pixel) {
  return std::visit(
      [&](auto m) -> std::optional<Eigen::Vector3d> {
        const double* a = parameters_of<decltype(m)>(camera);
        if (!(a[0] > 0 && a[1] > 0)) return std::nullopt;
        const Eigen::Vector2d target((pixel[0] - a[2]) / (a[0] * a[1]), (pixel[1] - a[3]) / a[0]);
        Eigen::Vector2d x = target;
        auto d = m.distort(x, a + core_parameter_count);
        for (int iteration = 0; iteration < 50; ++iteration) {
          const Eigen::Vector2d miss = d.x - target;
          if (!(miss.norm() > 1e-15 * (1 + target.norm()))) break;
          Eigen::Vector2d step = d.by_x.inverse() * miss;
          // Halve the step until it helps, so that a start beyond the fold does not diverge.
          bool is_closer = false;
          for (int halving = 0; halving < 20 && !is_closer; ++halving) {
            d = m.distort(x - step, a + core_parameter_count);
            is_closer = (d.x - target).norm() < miss.norm();
            if (!is_closer) step *= 0.5;
          }
          x -= step;
          if (!is_closer) d = m.distort(x, a + core_parameter_count);
          if (!is_closer || step.norm() < 1e-16 * (1 + x.norm())) break;  // at rounding, or a fold
        }
        const bool found = (d.x - target).norm() < 1e-10;
        if (!found || d.by_x.determinant() <= 0 || d.by_x.trace() <= 0) return std::nullopt;
        return Eigen::Vector3d(x[0], x[1], 1);
      },
      camera.model);
}

Eigen::Vector3d unproject(const Camera& camera, const Eigen::Vector2d& pixel) {
  if (const auto ray = try_unproject(camera, pixel)) return *ray;
  throw Error("camera \"" + camera.name + "\"",
              "its distortion cannot be inverted at pixel (" + std::to_string(pixel[0]) + ", " +
                  std::to_string(pixel[1]) + ")",
              "the coefficients fold the image there: calibrate with corners that reach the "
              "image's edge, or use a model with fewer coefficients");
}

bool in_image(const Camera& camera, const Eigen::Vector2d& pixel) {
  return pixel[0] >= -0.5 && pixel[1] >= -0.5 && pixel[0] <= camera.size_px[0] - 0.5 &&
         pixel[1] <= camera.size_px[1] - 0.5;
}

}  // namespace vernier
