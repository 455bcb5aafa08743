// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "calib/pose.h"
#include "calib/statistics/random.h"
#include "localise/joined_lines.h"

namespace vernier::test {

struct TrueLine {
  Eigen::Vector3d a_m, b_m;
};

/// Which line of the truth every segment shows.
struct Scene {
  std::vector<localise::SegmentsOfView> views;
  std::vector<std::vector<int>> truth;
};

/// A camera at `eye` that looks at `target`, z of the world up.
inline Pose looking(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  const Eigen::Vector3d z = (target - eye).normalized(),
                        x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d R;
  R << x, z.cross(x), z;
  return {R, eye};
}

/// Covariance of an end: 0.4 px across the ray at f = 500 px, 1.5e-3 z² along it.
inline Eigen::Matrix3d covariance_of(const Eigen::Vector3d& p) {
  const Eigen::Vector3d ray = p.normalized();
  const double across = 0.4 / 500 * p.norm(), along = 0.002 + 1.5e-3 * p.squaredNorm();
  return across * across * Eigen::Matrix3d::Identity() +
         (along * along - across * across) * ray * ray.transpose();
}

/// Adds what a camera sees of a line: a random part, with noise drawn from its covariance.
inline void add_sighting(localise::SegmentsOfView& view,
                         const Pose& T_camera_world,
                         const TrueLine& line,
                         vernier::internal::RandomStream& draws) {
  const double t0 = draws.uniform(0, 0.3), t1 = draws.uniform(0.7, 1);
  const Eigen::Vector3d d = line.b_m - line.a_m;
  Eigen::Vector3d a = T_camera_world * Eigen::Vector3d(line.a_m + t0 * d);
  Eigen::Vector3d b = T_camera_world * Eigen::Vector3d(line.a_m + t1 * d);
  if (draws.uniform() < 0.5) std::swap(a, b);
  localise::SightedSegment s;
  s.covariance_m2.setZero();
  s.covariance_m2.topLeftCorner<3, 3>() = covariance_of(a);
  s.covariance_m2.bottomRightCorner<3, 3>() = covariance_of(b);
  // depths of both ends err together in part, as those of one edge
  const Eigen::Vector3d ra = a.normalized(), rb = b.normalized();
  const double common = 1e-6 * a.squaredNorm() * b.squaredNorm();
  s.covariance_m2.topRightCorner<3, 3>() = common * ra * rb.transpose();
  s.covariance_m2.bottomLeftCorner<3, 3>() = common * rb * ra.transpose();
  const Eigen::VectorXd noise = s.covariance_m2.llt().matrixL() * draws.normals(6);
  s.a_m = a + noise.head<3>();
  s.b_m = b + noise.tail<3>();
  view.segments.push_back(s);
}

/// Views from a ring about the lines. Their poses err as `options` say; `shared` moves the lines.
inline Scene scene_of(const std::vector<TrueLine>& lines,
                      int views,
                      std::uint32_t trial,
                      const localise::JoinOptions& options,
                      double seen_share = 1) {
  Scene scene;
  for (int v = 0; v < views; ++v) {
    vernier::internal::RandomStream draws(
        {.seed = 5, .trial = trial, .feature = static_cast<std::uint32_t>(v)});
    const double angle = draws.uniform(-1, 1) + 0.3 * v;
    const Eigen::Vector3d eye(3 * std::cos(angle), 3 * std::sin(angle), draws.uniform(1, 1.8));
    const Pose T_world_camera = looking(eye, Eigen::Vector3d(0, 0, 1.2));
    localise::SegmentsOfView view;
    scene.truth.emplace_back();
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (draws.uniform() > seen_share) continue;
      add_sighting(view, T_world_camera.inverse(), lines[i], draws);
      scene.truth.back().push_back(static_cast<int>(i));
    }
    const Eigen::Vector3d turn = options.view_turn_rad * draws.normals(3);
    const Eigen::Vector3d step = options.view_position_m * draws.normals(3);
    view.T_world_camera = {rotation_from_vector(turn) * T_world_camera.R, T_world_camera.t + step};
    scene.views.push_back(view);
  }
  return scene;
}

/// Lines of a room: at random places and directions.
inline std::vector<TrueLine> random_lines(int count, std::uint32_t trial) {
  std::vector<TrueLine> lines;
  for (int i = 0; i < count; ++i) {
    vernier::internal::RandomStream draws(
        {.seed = 6, .trial = trial, .feature = static_cast<std::uint32_t>(i)});
    const Eigen::Vector3d middle{draws.uniform(-1.5, 1.5), draws.uniform(-1.5, 1.5),
                                 draws.uniform(0, 2.4)};
    const Eigen::Vector3d way(draws.normals(3));
    const Eigen::Vector3d along = way.normalized() * draws.uniform(0.15, 0.8);
    lines.push_back({middle - along, middle + along});
  }
  return lines;
}

}  // namespace vernier::test
