// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/camera/opencv_intrinsics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <variant>

#include "calib/camera.h"
#include "calib/camera/rig_limits.h"
#include "calib/error.h"
#include "calib/lens_models.h"

namespace vernier::internal {
namespace {

constexpr std::array<const char*, 14> opencv_order{"k1", "k2", "p1", "p2", "k3", "k4", "k5",
                                                   "k6", "s1", "s2", "s3", "s4", "tx", "ty"};
constexpr std::array<const char*, 4> fisheye_order{"k1", "k2", "k3", "k4"};

/// Whether the model's coefficients stand at the places of OpenCV's, as is relied on below.
template <class Model>
constexpr bool has_opencv_order() {
  constexpr auto& names = Model::distortion_names;
  const auto same = [](std::string_view a, const char* b) { return a == b; };
  if (std::is_same_v<Model, Fisheye4>) {
    return std::equal(names.begin(), names.end(), fisheye_order.begin(), fisheye_order.end(), same);
  }
  return names.size() <= opencv_order.size() &&
         std::equal(names.begin(), names.end(), opencv_order.begin(), same);
}
static_assert(
    []<class... Models>(std::type_identity<std::variant<Models...>>) {
      return (has_opencv_order<Models>() && ...);
    }(std::type_identity<CameraModel>{}),
    "a model in another order needs a case of its own");

const char* coefficient_name(bool fisheye, std::size_t i) {
  return fisheye ? fisheye_order.at(i) : opencv_order.at(i);
}

int distortion_count(const CameraModel& model) {
  return parameter_count(model) - core_parameter_count;
}

/// The first non-zero coefficient from index `count` on.
std::optional<std::size_t> first_beyond(const std::vector<double>& coefficients,
                                        std::size_t count) {
  for (std::size_t i = count; i < coefficients.size(); ++i) {
    if (coefficients[i] != 0) return i;
  }
  return std::nullopt;
}

CameraModel smallest_model(const OpenCvIntrinsics& intrinsics) {
  if (intrinsics.fisheye) return Fisheye4{};
  const auto last = std::find_if(intrinsics.coefficients.rbegin(), intrinsics.coefficients.rend(),
                                 [](double k) { return k != 0; });
  const auto needed = intrinsics.coefficients.rend() - last;
  if (needed == 0) return Pinhole{};
  if (needed == 1) return Radial1{};
  if (needed <= 4) return OpenCv4{};
  if (needed == 5) return OpenCv5{};
  return OpenCv8{};
}

void check(const OpenCvIntrinsics& i, const Eigen::Vector2i& size_px, const std::string& place) {
  const std::array<double, 4> core{i.fx_px, i.fy_px, i.cx_px, i.cy_px};
  const auto finite = [](double x) { return std::isfinite(x); };
  if (!std::all_of(core.begin(), core.end(), finite) ||
      !std::all_of(i.coefficients.begin(), i.coefficients.end(), finite)) {
    throw Error(place, "an intrinsic parameter is not finite", "correct it");
  }
  const auto beyond = [](double x) { return std::abs(x) > most_value; };
  if (std::any_of(core.begin(), core.end(), beyond) ||
      std::any_of(i.coefficients.begin(), i.coefficients.end(), beyond)) {
    throw Error(place, fmt::format("an intrinsic parameter is beyond {:g}", most_value),
                "correct it");
  }
  if (!(i.fx_px > 0) || !(i.fy_px > 0)) {
    throw Error(place, fmt::format("its focal lengths are {} and {}", i.fx_px, i.fy_px),
                "both must be above 0 (0: the camera was never calibrated)");
  }
  if (i.fx_px > most_focal_ratio * i.fy_px || i.fy_px > most_focal_ratio * i.fx_px) {
    throw Error(place, fmt::format("its focal lengths are {} and {}", i.fx_px, i.fy_px),
                fmt::format("they may differ by a factor of {}", most_focal_ratio));
  }
  constexpr double least_px = 1e-3, most_px = 1e9;
  if (std::min(i.fx_px, i.fy_px) < least_px || std::max(i.fx_px, i.fy_px) > most_px) {
    throw Error(place, fmt::format("its focal lengths are {} and {} px", i.fx_px, i.fy_px),
                fmt::format("both must be from {} to {}", least_px, most_px));
  }
  if (size_px.minCoeff() < 1) {
    throw Error(place, fmt::format("its image size is {} x {}", size_px[0], size_px[1]),
                "both must be above 0");
  }
}

}  // namespace

Eigen::Matrix3d camera_matrix(const OpenCvIntrinsics& i) {
  Eigen::Matrix3d K;
  K << i.fx_px, 0, i.cx_px, 0, i.fy_px, i.cy_px, 0, 0, 1;
  return K;
}

OpenCvIntrinsics intrinsics_of_camera_matrix(const Eigen::Matrix3d& K, const std::string& place) {
  if (K(0, 1) != 0) {
    throw Error(place, fmt::format("has a skew of {}, which is not supported", K(0, 1)),
                "calibrate without skew");
  }
  if (K(1, 0) != 0 || K(2, 0) != 0 || K(2, 1) != 0 || K(2, 2) != 1) {
    throw Error(place, "is not a camera matrix [fx 0 cx; 0 fy cy; 0 0 1]", "correct it");
  }
  return {K(0, 0), K(1, 1), K(0, 2), K(1, 2), false, {}};
}

OpenCvIntrinsics opencv_intrinsics(const Camera& camera) {
  OpenCvIntrinsics out{camera.f_px() * camera.ax(),
                       camera.f_px(),
                       camera.ox_px(),
                       camera.oy_px(),
                       std::holds_alternative<Fisheye4>(camera.model),
                       {}};
  for (Eigen::Index i = core_parameter_count; i < camera.parameters.size(); ++i) {
    out.coefficients.push_back(camera.parameters[i]);
  }
  if (std::holds_alternative<Radial1>(camera.model)) out.coefficients.resize(4, 0.0);
  return out;
}

std::vector<double> held_coefficients(const Camera& camera,
                                      std::size_t count,
                                      const std::string& tool) {
  OpenCvIntrinsics i = opencv_intrinsics(camera);
  if (const auto beyond = first_beyond(i.coefficients, count)) {
    throw Error(fmt::format("camera \"{}\"", camera.name),
                fmt::format("{} cannot represent {} = {} of the model {}", tool,
                            coefficient_name(i.fisheye, *beyond), i.coefficients[*beyond],
                            model_name(camera.model)),
                "calibrate with a smaller model, or choose another format");
  }
  i.coefficients.resize(count, 0.0);
  return i.coefficients;
}

Camera camera_from_opencv(const OpenCvIntrinsics& intrinsics,
                          const Eigen::Vector2i& size_px,
                          const std::string& place,
                          const std::optional<CameraModel>& wanted) {
  check(intrinsics, size_px, place);
  const CameraModel model = wanted.value_or(smallest_model(intrinsics));
  if (intrinsics.fisheye != std::holds_alternative<Fisheye4>(model)) {
    throw Error(place,
                fmt::format("is {}a fisheye camera, which the model {} cannot represent",
                            intrinsics.fisheye ? "" : "not ", model_name(model)),
                "choose another model or none");
  }
  const int count = distortion_count(model);
  if (const auto beyond = first_beyond(intrinsics.coefficients, static_cast<std::size_t>(count))) {
    throw Error(place,
                fmt::format("the coefficient {} = {} of its distortion is not in the model {}",
                            coefficient_name(intrinsics.fisheye, *beyond),
                            intrinsics.coefficients[*beyond], model_name(model)),
                wanted ? "choose a larger model or none" : "no supported model includes it");
  }
  Camera camera;
  camera.name.clear();
  camera.size_px = size_px;
  camera.model = model;
  camera.parameters = Eigen::VectorXd::Zero(core_parameter_count + count);
  camera.parameters.head<core_parameter_count>() << intrinsics.fy_px,
      intrinsics.fx_px / intrinsics.fy_px, intrinsics.cx_px, intrinsics.cy_px;
  for (std::size_t i = 0; i < std::min<std::size_t>(count, intrinsics.coefficients.size()); ++i) {
    camera.parameters[core_parameter_count + static_cast<Eigen::Index>(i)] =
        intrinsics.coefficients[i];
  }
  return camera;
}

}  // namespace vernier::internal
