// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/rectification/vertical_disparity.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>

#include "calib/base/decompositions.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/sampler.h"
#include "calib/triangulation.h"
#include "calib/uncertainty/sampled_propagation.h"
#include "stereo/rectification.h"

namespace vernier::stereo::internal {

using namespace vernier::internal;

namespace {

using Eigen::Vector3d;

/// Rays (x, y, 1) of a pair.
struct RayPair {
  Vector3d left, right;
};

std::optional<RayPair> rays_of(const Rig& rig, const PixelPair& pair) {
  const auto left = try_unproject(rig.cameras[0], pair.first_px);
  const auto right = try_unproject(rig.cameras[1], pair.other_px);
  if (!left || !right) return std::nullopt;
  return RayPair{*left, *right};
}

/// Derivative of a row (a linear form of the ray) by the camera's parameters at a fixed pixel.
Eigen::RowVectorXd through_ray(const Camera& camera,
                               const Vector3d& ray,
                               const Eigen::RowVector3d& row) {
  ProjectionJacobian J;
  project(camera, ray, J);
  const Eigen::Matrix2d inverse = J.point.leftCols<2>().inverse();
  return -row.head<2>() * inverse * J.camera;
}

/// The part of J C Jᵀ outside the column space of X, as its trace: tr(C JᵀJ) − tr(C (QᵀJ)ᵀ QᵀJ)
/// with Q an orthonormal basis of X.
double unexplained(const Eigen::MatrixXd& J, const Eigen::MatrixXd& C, const Eigen::MatrixXd& X) {
  const Eigen::MatrixXd Q = orthonormal_basis(X);
  const Eigen::MatrixXd rest = J - Q * (Q.transpose() * J);
  return (rest * C).cwiseProduct(rest).sum();
}

std::vector<double> ticks(int count, int size_px) {
  std::vector<double> at(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) at[i] = static_cast<double>(i) * (size_px - 1) / (count - 1);
  return at;
}

void check_grid(const Rig& rig, int columns, int rows, double distance_m) {
  const std::string place = "vertical disparity";
  if (rig.cameras.size() != 2) {
    throw Error(place, fmt::format("the rig has {} cameras", rig.cameras.size()),
                "use a rig of two cameras");
  }
  if (columns < 2 || rows < 2) {
    throw Error(place, fmt::format("the grid is {}x{}", columns, rows), "use at least 2x2");
  }
  if (!(distance_m > 0)) {
    throw Error(place, fmt::format("the distance is {} m", distance_m),
                "use a distance above 0, or inf");
  }
}

/// Root mean variances from the derivatives J of the visible points at (x, y).
void summarise(const Eigen::MatrixXd& J,
               const Eigen::MatrixXd& C,
               const Eigen::MatrixXd& affine,
               VerticalDisparityMap& map) {
  const auto seen = static_cast<double>(J.rows());
  const Eigen::RowVectorXd mean = J.colwise().mean();
  map.mean_sd_px = std::sqrt((mean * C * mean.transpose()).value());
  map.rms_px = std::sqrt((J * C).cwiseProduct(J).sum() / seen);
  map.rms_less_mean_px = std::sqrt(std::max(0.0, unexplained(J, C, affine.leftCols(1)) / seen));
  map.rms_less_affine_px = std::sqrt(std::max(0.0, unexplained(J, C, affine) / seen));
}

}  // namespace

std::optional<double> vertical_disparity_px(const Rig& rig,
                                            const PixelPair& pair,
                                            double rectified_f_px) {
  const Rectification R = rectification(rig);
  const auto rays = rays_of(rig, pair);
  if (!rays) return std::nullopt;
  const Vector3d left = R.R_rectified_left * rays->left;
  const Vector3d right = R.R_rectified_right * rays->right;
  if (!(left.z() > 0) || !(right.z() > 0)) return std::nullopt;
  return rectified_f_px * (left.y() / left.z() - right.y() / right.z());
}

std::optional<Eigen::RowVectorXd> vertical_disparity_by_rig(const Rig& rig,
                                                            const PixelPair& pair,
                                                            double rectified_f_px) {
  const Rectification R = rectification(rig);
  const auto rays = rays_of(rig, pair);
  if (!rays) return std::nullopt;
  const Pose& T = rig.T_camera_first[1];
  const Vector3d turned = T.R * rays->left;
  const Vector3d n = T.t.cross(turned);
  const double y1_z = (R.R_rectified_right * rays->right).z();
  const double n_y = (R.R_rectified_right * n).y();
  if (!(y1_z > 0) || n_y == 0) return std::nullopt;
  // e = x1ᵀ [T]x R x0
  const Eigen::RowVector3d by_turned = rays->right.transpose() * hat(T.t);
  Eigen::RowVectorXd by_rig = Eigen::RowVectorXd::Zero(parameter_count(rig));
  const auto left_count = rig.cameras[0].parameters.size();
  by_rig.segment(0, left_count) = through_ray(rig.cameras[0], rays->left, by_turned * T.R);
  by_rig.segment(left_count, rig.cameras[1].parameters.size()) =
      through_ray(rig.cameras[1], rays->right, n.transpose());
  const int pose = pose_index(rig, 1);
  by_rig.segment<3>(pose) = -by_turned * hat(turned);                    // R -> exp(w) R
  by_rig.segment<3>(pose + 3) = -rays->right.transpose() * hat(turned);  // T -> T + τ
  return -rectified_f_px / (y1_z * n_y) * by_rig;
}

std::optional<PixelPair> pair_at_distance(const Rig& rig,
                                          const Eigen::Vector2d& left_px,
                                          double distance_m) {
  const auto ray = try_unproject(rig.cameras[0], left_px);
  if (!ray) return std::nullopt;
  const Pose& T = rig.T_camera_first[1];
  const Vector3d direction = ray->normalized();
  const Vector3d x =
      std::isinf(distance_m) ? Vector3d(T.R * direction) : Vector3d(T * (distance_m * direction));
  const auto right_px = try_project(rig.cameras[1], x);
  if (!right_px || !in_image(rig.cameras[1], *right_px)) return std::nullopt;
  return PixelPair{left_px, *right_px};
}

VerticalDisparityMap vertical_disparity_map(
    const Rig& rig, const Eigen::MatrixXd& C, int columns, int rows, double distance_m) {
  check_grid(rig, columns, rows, distance_m);
  const Eigen::Vector2i size = rig.cameras[0].size_px;
  VerticalDisparityMap map;
  map.columns = columns;
  map.rows = rows;
  map.x_px = ticks(columns, size[0]);
  map.y_px = ticks(rows, size[1]);
  map.rectified_f_px = 0.5 * (rig.cameras[0].f_px() + rig.cameras[1].f_px());
  Eigen::MatrixXd J(columns * rows, parameter_count(rig)), affine(columns * rows, 3);
  Eigen::Index seen = 0;
  for (const double y : map.y_px) {
    for (const double x : map.x_px) {
      const auto pair = pair_at_distance(rig, {x, y}, distance_m);
      const auto row = pair ? vertical_disparity_by_rig(rig, *pair, map.rectified_f_px)
                            : std::optional<Eigen::RowVectorXd>();
      if (!row) {
        ++map.absent;
        map.sd_px.push_back(std::numeric_limits<double>::quiet_NaN());
        continue;
      }
      map.sd_px.push_back(std::sqrt((*row * C * row->transpose()).value()));
      affine.row(seen) << 1, x / size[0], y / size[1];
      J.row(seen++) = *row;
    }
  }
  if (seen < 3) {
    map.rms_px = map.mean_sd_px = map.rms_less_mean_px = map.rms_less_affine_px =
        std::numeric_limits<double>::quiet_NaN();
    return map;
  }
  summarise(J.topRows(seen), C, affine.topRows(seen), map);
  return map;
}

std::vector<SampledDisparity> sampled_vertical_disparity(const RigSampler& sampler,
                                                         std::span<const PixelPair> pairs,
                                                         double rectified_f_px,
                                                         const SamplingOptions& options) {
  if (options.samples < 2)
    throw Error("vertical disparity", "fewer than 2 samples", "use at least 2");
  std::vector<double> sum(pairs.size(), 0), squares(pairs.size(), 0);
  std::vector<int> count(pairs.size(), 0);
  for (int i = 0; i < options.samples; ++i) {
    const Rig drawn = sampler.sample(options.psi_c, options.seed, static_cast<std::uint32_t>(i));
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const auto dy = vertical_disparity_px(drawn, pairs[k], rectified_f_px);
      if (!dy) continue;
      sum[k] += *dy;
      squares[k] += *dy * *dy;
      ++count[k];
    }
  }
  std::vector<SampledDisparity> result;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const double mean = sum[k] / count[k];  // 0/0, NaN, if no draw is physical
    const double spread = squares[k] - count[k] * mean * mean;
    result.push_back({mean, std::sqrt((spread < 0 ? 0 : spread) / (count[k] - 1)),
                      1 - static_cast<double>(count[k]) / options.samples});
  }
  return result;
}

}  // namespace vernier::stereo::internal
