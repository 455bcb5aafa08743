// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/uncertainty/target_quantity.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>

#include "calib/base/shown_text.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/estimate/rig_part.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/triangulation.h"

namespace vernier::internal {
namespace {

constexpr int grid_columns = 8, grid_rows = 6;
constexpr const char* no_pair = "choose projection or a parameter";

/// Central differences along each parameter: steps of 1e-3 px, 1e-6 in everything else.
Eigen::MatrixXd derivative(const Rig& rig,
                           const std::function<Eigen::VectorXd(const Rig&)>& value) {
  const std::vector<std::string> names = parameter_names(rig);
  const auto n = static_cast<Eigen::Index>(names.size());
  Eigen::MatrixXd G(value(rig).size(), n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double step = names[static_cast<std::size_t>(k)].ends_with("_px") ? 1e-3 : 1e-6;
    const Eigen::VectorXd delta = step * Eigen::VectorXd::Unit(n, k);
    G.col(k) = (value(retract(rig, delta)) - value(retract(rig, -delta))) / (2 * step);
  }
  return G;
}

/// Pixels at the centres of a grid's cells, so that all represent the same area.
std::vector<Eigen::Vector2d> cell_middles(const Camera& camera) {
  std::vector<Eigen::Vector2d> pixels;
  for (int row = 0; row < grid_rows; ++row) {
    for (int column = 0; column < grid_columns; ++column) {
      pixels.emplace_back((column + 0.5) * camera.size_px[0] / grid_columns - 0.5,
                          (row + 0.5) * camera.size_px[1] / grid_rows - 0.5);
    }
  }
  return pixels;
}

/// Points at the depth `at_m` of a camera, in the rig's frame.
std::vector<Eigen::Vector3d> points_seen(const Rig& rig, int camera, double at_m) {
  const Pose T_first_camera = rig.T_camera_first[camera].inverse();
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector2d& pixel : cell_middles(rig.cameras[camera])) {
    const auto ray = try_unproject(rig.cameras[camera], pixel);
    if (ray) points.push_back(T_first_camera * (at_m * *ray));
  }
  return points;
}

Eigen::MatrixXd depth_gradient(const Rig& rig, double at_m) {
  const Eigen::Vector3d x(0, 0, at_m), x_right = rig.T_camera_first[1] * x;
  if (!(x_right.z() > 0)) {
    throw Error("depth", fmt::format("a point {} m ahead is behind the right camera", at_m),
                "choose another distance");
  }
  const PixelPair pair{project(rig.cameras[0], x), project(rig.cameras[1], x_right)};
  // The inverse depth is nearly linear in the parameters, however small the disparity.
  return -at_m * at_m * derivative(rig, [&](const Rig& moved) {
    return Eigen::VectorXd::Constant(1, 1 / triangulated_depth_m(moved, pair));
  });
}

Eigen::MatrixXd projection_gradient(const Rig& rig, double at_m) {
  std::vector<std::vector<Eigen::Vector3d>> points;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    points.push_back(points_seen(rig, static_cast<int>(c), at_m));
  }
  return derivative(rig, [&](const Rig& moved) {
    std::vector<double> pixels;
    for (std::size_t c = 0; c < points.size(); ++c) {
      for (const Eigen::Vector3d& x : points[c]) {
        const Eigen::Vector2d pixel = project(moved.cameras[c], moved.T_camera_first[c] * x);
        pixels.insert(pixels.end(), {pixel.x(), pixel.y()});
      }
    }
    return Eigen::VectorXd(Eigen::Map<Eigen::VectorXd>(pixels.data(), Eigen::Index(pixels.size())));
  });
}

/// Axes of the rectified cameras in the rig's frame, one per row: x along the baseline, z as close
/// as possible to the mean of the optical axes. A rotation of both cameras about the baseline moves
/// both rows of a point alike, so other choices do not change their difference to first order.
Eigen::Matrix3d rectified_axes(const Rig& rig) {
  const Pose T_first_right = rig.T_camera_first[1].inverse();
  Eigen::Matrix3d R;
  R.row(0) = T_first_right.t.normalized().transpose();
  const Eigen::Vector3d ahead = Eigen::Vector3d::UnitZ() + T_first_right.R.col(2);
  R.row(1) = ahead.cross(Eigen::Vector3d(R.row(0))).normalized().transpose();
  R.row(2) = R.row(0).cross(R.row(1));
  return R;
}

Eigen::MatrixXd rectification_gradient(const Rig& rig, double at_m) {
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> matches;
  for (const Eigen::Vector3d& x : points_seen(rig, 0, at_m)) {
    const Eigen::Vector3d x_right = rig.T_camera_first[1] * x;
    if (!(x_right.z() > 0)) continue;
    const Eigen::Vector2d right = project(rig.cameras[1], x_right);
    if (!in_image(rig.cameras[1], right) || !try_unproject(rig.cameras[1], right)) continue;
    matches.emplace_back(project(rig.cameras[0], x), right);
  }
  if (matches.empty()) {
    throw Error("rectification", fmt::format("the images do not overlap at {} m", at_m),
                "choose a greater distance");
  }
  const double f = 0.5 * (rig.cameras[0].f_px() + rig.cameras[1].f_px());
  return derivative(rig, [&](const Rig& moved) {
    const Eigen::Matrix3d R = rectified_axes(moved);
    const Eigen::Matrix3d R_right = R * moved.T_camera_first[1].R.transpose();
    Eigen::VectorXd rows(Eigen::Index(matches.size()));
    for (std::size_t i = 0; i < matches.size(); ++i) {
      const Eigen::Vector3d left = R * unproject(moved.cameras[0], matches[i].first);
      const Eigen::Vector3d right = R_right * unproject(moved.cameras[1], matches[i].second);
      rows[Eigen::Index(i)] = f * (left.y() / left.z() - right.y() / right.z());
    }
    return rows;
  });
}

std::string unit_of(const std::string& parameter) {
  for (const char* unit : {"px", "rad", "m"}) {
    if (parameter.ends_with(std::string("_") + unit)) return unit;
  }
  return "";
}

TargetQuantity parameter_error(const Rig& rig, const std::string& name) {
  const std::vector<std::string> names = parameter_names(rig);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw Error(
        in_quotes(name), "unknown quantity",
        fmt::format("supported: depth, projection, rectification, baseline or a parameter: {}",
                    fmt::join(names, " ")));
  }
  const auto n = static_cast<Eigen::Index>(names.size());
  return {name, unit_of(name), Eigen::RowVectorXd::Unit(n, found - names.begin())};
}

}  // namespace

double sd_of(const TargetQuantity& wanted, const Eigen::MatrixXd& factor) {
  return std::sqrt((wanted.gradient * factor).squaredNorm() /
                   static_cast<double>(wanted.gradient.rows()));
}

TargetQuantity target_quantity(const Rig& rig, const std::string& what, double at_m) {
  constexpr double farthest_m = 1e6;
  if (!(at_m > 0 && at_m <= farthest_m)) {
    throw Error(what, "its distance is not above 0 and at most 1e6 m", "give metres");
  }
  if (what == "depth") {
    require_pair(rig, what, "RIG", no_pair);
    return {fmt::format("depth at {} m", at_m), "m", depth_gradient(rig, at_m)};
  }
  if (what == "projection") {
    return {fmt::format("projection at {} m", at_m), "px", projection_gradient(rig, at_m)};
  }
  if (what == "rectification") {
    require_pair(rig, what, "RIG", no_pair);
    return {fmt::format("vertical disparity at {} m", at_m), "px",
            rectification_gradient(rig, at_m)};
  }
  if (what == "baseline") {
    require_pair(rig, what, "RIG", no_pair);
    Eigen::RowVectorXd g = Eigen::RowVectorXd::Zero(parameter_count(rig));
    g.tail<3>() = rig.T_camera_first[1].t.normalized().transpose();
    return {"baseline", "m", g};
  }
  return parameter_error(rig, what);
}

TargetQuantity target_quantity(const Rig& rig,
                               const std::vector<int>& cameras,
                               const std::string& what,
                               double at_m) {
  TargetQuantity wanted = target_quantity(part_of(rig, cameras), what, at_m);
  wanted.gradient *= part_by_rig(rig, cameras);
  return wanted;
}

}  // namespace vernier::internal
