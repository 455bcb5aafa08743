// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

#include "calib/board_observations.h"
#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/statistics/random.h"

namespace vernier::test {

/// Two fisheyes side by side whose images show more than a half-space.
inline Rig wide_rig() {
  Camera camera;
  camera.name = "left";
  camera.size_px = {1280, 960};
  camera.model = Fisheye4{};
  camera.parameters.resize(8);
  camera.parameters << 300, 1, 641, 478, 0.012, -0.004, 0.002, -0.0008;
  Camera right = camera;
  right.name = "right";
  return {{camera, right}, {Pose{}, Pose{rotation_from_vector({0.01, 0.1, 0}), {-0.1, 0, 0}}}};
}

/// The projection of Kannala and Brandt (IEEE PAMI 28, 2006), which has no limit at 90 degrees.
inline Eigen::Vector2d seen_by(const Camera& camera, const Eigen::Vector3d& x) {
  const double r = x.head<2>().norm(), t = std::atan2(r, x.z()), t2 = t * t;
  const auto k = camera.parameters.tail<4>();
  const double along = t * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
  const Eigen::Vector2d d = x.head<2>() * (r > 0 ? along / r : 1);
  return {camera.f_px() * camera.ax() * d[0] + camera.ox_px(),
          camera.f_px() * d[1] + camera.oy_px()};
}

struct WideViewOptions {
  double most_deg = 85;  ///< from the axis: corners beyond are not seen
  std::uint64_t seed = 7;
  double square_m = 0.06;
  double from_axis_deg = 60;  ///< of the board's middle, at most
  int frames = 30;
  int edge_frames = 0;  ///< further frames, the board at 2 m and 84.5 to 85 degrees, up or down
};

struct WideViews {
  BoardObservations observations;
  int beyond = 0;  ///< corners beyond 90 degrees
};

/// Views by a rig of fisheyes of a board of 12 x 9 corners close before it, with noise of 0.2 px.
inline WideViews wide_views(const Rig& rig, const WideViewOptions& options) {
  constexpr int columns = 12, rows = 9;
  constexpr double sigma_px = 0.2, degree = std::numbers::pi / 180;
  WideViews seen{{{rig.cameras[0].size_px, rig.cameras[1].size_px}, {}, {}}, 0};
  BoardObservations& all = seen.observations;
  for (int i = 0; i < columns * rows; ++i) {
    all.target_m.emplace_back(options.square_m * (i % columns), options.square_m * (i / columns),
                              0);
  }
  const Eigen::Vector3d middle = 0.5 * (all.target_m.front() + all.target_m.back());
  vernier::internal::RandomStream d({.seed = options.seed});
  for (int frame = 0; frame < options.frames + options.edge_frames; ++frame) {
    const bool edge = frame >= options.frames;
    double from_axis = options.from_axis_deg * degree * std::sqrt(d.uniform());
    double around = d.uniform(0, 6.28), distance_m = d.uniform(0.35, 0.8);
    if (edge) {
      from_axis = d.uniform(84.5, 85) * degree;
      around = (frame % 2 == 0 ? 0.5 : 1.5) * std::numbers::pi;
      distance_m = 2;
    }
    const Eigen::Vector3d at =
        distance_m * Eigen::Vector3d(std::sin(from_axis) * std::cos(around),
                                     std::sin(from_axis) * std::sin(around), std::cos(from_axis));
    // It faces the camera, but for a tilt.
    const Eigen::Matrix3d R =
        rotation_from_vector(from_axis * Eigen::Vector3d(-std::sin(around), std::cos(around), 0)) *
        rotation_from_vector({d.uniform(-0.5, 0.5), d.uniform(-0.5, 0.5), d.uniform(-3, 3)});
    const Pose T_first_board{R, at - R * middle};
    for (int c = 0; c < 2; ++c) {
      BoardView view{frame, c, "", {}, {}};
      for (int i = 0; i < columns * rows; ++i) {
        const Eigen::Vector3d x = rig.T_camera_first[c] * (T_first_board * all.target_m[i]);
        const Eigen::Vector2d pixel = seen_by(rig.cameras[c], x);
        const double angle = std::atan2(x.head<2>().norm(), x.z());
        const Eigen::Vector2d noise{d.normal(), d.normal()};
        if (angle > options.most_deg * degree || !in_image(rig.cameras[c], pixel)) continue;
        seen.beyond += angle > 90 * degree;
        view.ids.push_back(i);
        view.pixels_px.push_back(pixel + sigma_px * noise);
      }
      if (determines_pose(all.target_m, view.ids)) all.views.push_back(view);
    }
  }
  return seen;
}

inline std::size_t corners_of(const BoardObservations& observations) {
  std::size_t corners = 0;
  for (const BoardView& view : observations.views) corners += view.ids.size();
  return corners;
}

}  // namespace vernier::test
