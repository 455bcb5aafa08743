// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/held_parameters.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"

namespace vernier::internal {
namespace {

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

Eigen::Index index_of(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    const bool is_ay = ends_with(name, ".ay");
    throw Error("held parameter " + name,
                is_ay ? "ay is 1 by definition" : "the rig has no such parameter",
                fmt::format("use one of {}", fmt::join(names, " ")));
  }
  return found - names.begin();
}

void check_value(const HeldParameter& held) {
  if (!held.value) return;
  const bool positive = ends_with(held.name, ".f_px") || ends_with(held.name, ".ax");
  if (!std::isfinite(*held.value) || (positive && !(*held.value > 0))) {
    throw Error("held parameter " + held.name, fmt::format("invalid value {}", *held.value),
                positive ? "give a number above 0" : "give a finite number");
  }
}

/// Default values of held parameters: ax 1, the principal point at the image centre, no distortion.
/// Focal lengths and poses have no default and stay as they are.
Eigen::VectorXd neutral_parameters(const Rig& rig) {
  Rig neutral = rig;
  for (Camera& camera : neutral.cameras) {
    const Eigen::Vector2d middle = 0.5 * (camera.size_px.cast<double>() - Eigen::Vector2d::Ones());
    const double f = camera.f_px();
    camera.parameters.setZero();
    camera.parameters.head<core_parameter_count>() << f, 1, middle.x(), middle.y();
  }
  return parameters(neutral);
}

std::vector<Eigen::Index> free_places(const std::vector<bool>& held) {
  std::vector<Eigen::Index> places;
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (!held[i]) places.push_back(static_cast<Eigen::Index>(i));
  }
  return places;
}

}  // namespace

std::vector<bool> held_mask(const Rig& rig, const std::vector<HeldParameter>& held) {
  const std::vector<std::string> names = parameter_names(rig);
  std::vector<bool> mask(names.size(), false);
  for (const HeldParameter& h : held) {
    check_value(h);
    const auto i = static_cast<std::size_t>(index_of(names, h.name));
    if (mask[i]) throw Error("held parameter " + h.name, "is held twice", "hold it once");
    mask[i] = true;
  }
  return mask;
}

Rig with_held_values(const Rig& rig, const std::vector<HeldParameter>& held) {
  const std::vector<std::string> names = parameter_names(rig);
  const Eigen::VectorXd neutral = neutral_parameters(rig);
  Eigen::VectorXd a = parameters(rig);
  for (const HeldParameter& h : held) {
    check_value(h);
    const Eigen::Index i = index_of(names, h.name);
    a[i] = h.value.value_or(neutral[i]);
  }
  Rig result = rig;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    Eigen::VectorXd& own = result.cameras[c].parameters;
    own = a.segment(intrinsics_index(rig, static_cast<int>(c)), own.size());
    if (c == 0) continue;
    const int i = pose_index(rig, static_cast<int>(c));
    result.T_camera_first[c] = {rotation_from_vector(a.segment<3>(i)), a.segment<3>(i + 3)};
  }
  return result;
}

Eigen::MatrixXd tangent_by_values(const Rig& rig, const std::vector<bool>& held) {
  const auto p = static_cast<Eigen::Index>(held.size());
  Eigen::MatrixXd by_value = Eigen::MatrixXd::Identity(p, p);
  for (std::size_t c = 1; c < rig.cameras.size(); ++c) {
    const int i = pose_index(rig, static_cast<int>(c));
    // If the whole rotation is free, any basis will do; the identity keeps its rows readable.
    if (!held[i] && !held[i + 1] && !held[i + 2]) continue;
    by_value.block<3, 3>(i, i) = left_jacobian(vector_from_rotation(rig.T_camera_first[c].R));
  }
  return by_value;
}

Eigen::MatrixXd free_directions(const Rig& rig, const std::vector<bool>& held) {
  return tangent_by_values(rig, held)(Eigen::all, free_places(held));
}

Eigen::MatrixXd values_by_tangent(const Rig& rig, const std::vector<bool>& held) {
  Eigen::MatrixXd inverse = tangent_by_values(rig, held);
  for (std::size_t c = 1; c < rig.cameras.size(); ++c) {
    const int i = pose_index(rig, static_cast<int>(c));
    inverse.block<3, 3>(i, i) = inverse.block<3, 3>(i, i).inverse().eval();
  }
  return inverse;
}

Eigen::MatrixXd covariance_of_free(const Eigen::MatrixXd& C,
                                   const Rig& rig,
                                   const std::vector<bool>& held) {
  const std::vector<Eigen::Index> free = free_places(held);
  const Eigen::MatrixXd by_tangent = values_by_tangent(rig, held);
  if (by_tangent.isIdentity(0)) return C(free, free);
  return (by_tangent * C * by_tangent.transpose())(free, free);
}

std::vector<bool> without_variance(const Rig& rig, const Eigen::MatrixXd& C) {
  constexpr double rounding = 1e-12;  // of a rotation's largest
  std::vector<bool> none(static_cast<std::size_t>(C.rows()));
  for (Eigen::Index i = 0; i < C.rows(); ++i) none[static_cast<std::size_t>(i)] = !(C(i, i) > 0);
  for (int c = 1; c < static_cast<int>(rig.cameras.size()); ++c) {
    const int i = pose_index(rig, c);
    const Eigen::Matrix3d by_tangent =
        left_jacobian(vector_from_rotation(rig.T_camera_first[c].R)).inverse();
    const Eigen::Vector3d variance =
        (by_tangent * C.block<3, 3>(i, i) * by_tangent.transpose()).diagonal();
    for (int k = 0; k < 3; ++k) none[i + k] = !(variance[k] > rounding * variance.maxCoeff());
  }
  return none;
}

std::vector<std::string> free_names(const Rig& rig, const std::vector<bool>& held) {
  std::vector<std::string> free;
  const std::vector<std::string> names = parameter_names(rig);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!held[i]) free.push_back(names[i]);
  }
  return free;
}

std::vector<HeldParameter> held_by(const GaussianRigPrior& prior) {
  std::vector<HeldParameter> held;
  const std::vector<std::string> names = parameter_names(prior.rig);
  const Eigen::VectorXd a = parameters(prior.rig);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto& known = prior.covariance.names;
    if (std::find(known.begin(), known.end(), names[i]) != known.end()) continue;
    held.push_back({names[i], a[static_cast<Eigen::Index>(i)]});
  }
  return held;
}

}  // namespace vernier::internal
