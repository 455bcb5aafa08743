// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/statistics/random.h"
#include "sim/sequence/sequence_samples.h"
#include "stereo/image/depth_image.h"

namespace vernier::test {

/// What goes wrong in a made sequence. It uses none of the simulator's code.
struct MadeErrors {
  double lost = 0;         ///< probability that a view has nothing of a line
  double split = 0;        ///< probability that a line comes in two pieces, 6 px apart
  double across_px = 0.1;  ///< of each end
  double along_px = 0.5;
  double wrong_depth = 0;  ///< probability that a segment is 20 to 50 % too far
  double false_share = 0;  ///< of a view's segments: at random places, in this view alone
  double turn_rad = 0;     ///< of each view, about each axis, that the poses do not say
};

/// A camera that walks along a wall 4 m away with lines on it, past a board that hides some.
class MadeSequence {
 public:
  MadeSequence(const MadeErrors& errors, std::uint32_t trial, int views = 40, int lines = 160)
      : errors_(errors), trial_(trial) {
    camera_.model = Pinhole{};
    camera_.parameters = Eigen::Vector4d(500, 1, 319.5, 239.5);
    make_lines(lines);
    for (int v = 0; v < views; ++v) add_view(v, views);
  }

  /// Of the lines that were in view, drawn or not: their number, length, and those in two pieces.
  struct Counts {
    double lines = 0, px = 0, gaps_px = 0, split = 0, lost = 0;
  };
  const Counts& counts() const { return counts_; }

  const Camera& camera() const { return camera_; }
  const std::vector<sim::internal::SequenceView>& views() const { return views_; }
  std::vector<sim::internal::SequenceView>& views() { return views_; }
  stereo::internal::DepthImage depth(std::size_t view) const {
    stereo::internal::DepthImage map{640, 480, {}};
    for (int y = 0; y < 480; ++y) {
      for (int x = 0; x < 640; ++x) {
        map.depth_m.push_back(static_cast<float>(depth_at(true_poses_[view], {x, y})));
      }
    }
    return map;
  }

 private:
  struct Line {
    Eigen::Vector3d a_m, b_m;
  };

  vernier::internal::RandomStream draws(std::uint32_t feature, std::uint32_t source) const {
    return vernier::internal::RandomStream(
        {.seed = 77, .trial = trial_, .feature = feature, .source = 200 + source});
  }

  /// On the wall z = 4 m, at least 6 cm apart: no two are taken for each other.
  void make_lines(int count) {
    auto draw = draws(0, 0);
    for (int tries = 0; static_cast<int>(lines_.size()) < count && tries < 20 * count; ++tries) {
      const Eigen::Vector3d middle{draw.uniform(-3, 6), draw.uniform(-1.4, 1.4), 4};
      const double angle = draw.uniform(0, M_PI), half = draw.uniform(0.12, 0.3);
      const Eigen::Vector3d d = half * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
      const Line line{middle - d, middle + d};
      const bool apart = std::all_of(lines_.begin(), lines_.end(), [&](const Line& other) {
        for (int i = 0; i <= 12; ++i) {
          const Eigen::Vector3d p = line.a_m + i / 12.0 * (line.b_m - line.a_m);
          const Eigen::Vector3d e = other.b_m - other.a_m;
          const double t = std::clamp((p - other.a_m).dot(e) / e.squaredNorm(), -0.2, 1.2);
          if ((p - other.a_m - t * e).norm() < 0.08) return false;
        }
        return true;
      });
      if (apart) lines_.push_back(line);
    }
  }

  /// The wall, or the board 2.5 m away before a part of it.
  static double depth_at(const Pose& T_world_camera, const Eigen::Vector2d& px) {
    const Eigen::Vector3d ray =
        T_world_camera.R * Eigen::Vector3d((px.x() - 319.5) / 500, (px.y() - 239.5) / 500, 1);
    const double board = (2.5 - T_world_camera.t.z()) / ray.z();
    const Eigen::Vector3d there = T_world_camera.t + board * ray;
    if (std::abs(there.x() - 1) < 0.4 && std::abs(there.y()) < 0.5) return board;
    return (4 - T_world_camera.t.z()) / ray.z();
  }

  void add_view(int v, int views) {
    auto draw = draws(static_cast<std::uint32_t>(v), 1);
    Pose T;
    T.R = rotation_from_vector(
        {draw.uniform(-0.03, 0.03), draw.uniform(-0.25, 0.25), draw.uniform(-0.05, 0.05)});
    T.t = {-1 + 5.0 * v / views, draw.uniform(-0.05, 0.05), draw.uniform(-0.3, 0.3)};
    true_poses_.push_back(T);
    sim::internal::SequenceView view;
    const Eigen::Vector3d turn = errors_.turn_rad * draw.normals(3);
    view.T_world_camera = {rotation_from_vector(turn) * T.R, T.t};
    for (std::size_t i = 0; i < lines_.size(); ++i) add_line(T, lines_[i], v, i, view);
    const double many = errors_.false_share / (1 - errors_.false_share);
    const int false_ones =
        static_cast<int>(many * static_cast<double>(view.segments.size()) + draw.uniform());
    for (int k = 0; k < false_ones; ++k) {
      const Eigen::Vector2d middle{draw.uniform(60, 580), draw.uniform(60, 420)};
      const double angle = draw.uniform(0, 2 * M_PI), half = draw.uniform(10, 40);
      const Eigen::Vector2d d = half * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      add_segment(T, middle - d, middle + d, 1, draw, view);
    }
    views_.push_back(std::move(view));
  }

  std::optional<Eigen::Vector2d> seen(const Pose& T, const Eigen::Vector3d& p) const {
    const Eigen::Vector3d x = T.inverse() * p;
    const Eigen::Vector2d px = project(camera_, x);
    if (px.x() < 0 || px.y() < 0 || px.x() > 639 || px.y() > 479) return {};
    if (depth_at(T, px) < x.z() - 0.01) return {};  // behind the board
    return px;
  }

  void add_line(
      const Pose& T, const Line& line, int v, std::size_t i, sim::internal::SequenceView& view) {
    auto draw = draws(static_cast<std::uint32_t>(v * 1000 + static_cast<int>(i)), 2);
    const bool lost = draw.uniform() < errors_.lost, split = draw.uniform() < errors_.split;
    const double scale = draw.uniform() < errors_.wrong_depth ? draw.uniform(1.2, 1.5) : 1;
    constexpr int samples = 400;  // the longest part in the image that is not hidden
    int first = 0, best_first = 0, best = 0, run = 0;
    for (int k = 0; k <= samples; ++k) {
      if (seen(T, line.a_m + k / double(samples) * (line.b_m - line.a_m))) {
        if (run++ == 0) first = k;
        if (run > best) {
          best = run;
          best_first = first;
        }
      } else {
        run = 0;
      }
    }
    if (best < 2) return;
    const auto at = [&](int k) {
      return *seen(T, line.a_m + k / double(samples) * (line.b_m - line.a_m));
    };
    const Eigen::Vector2d a = at(best_first), b = at(best_first + best - 1), d = b - a;
    constexpr double gap_px = 6;
    if (d.norm() < 10) return;
    const bool in_two = split && d.norm() >= 40;
    counts_.lines += 1;
    counts_.lost += lost;
    if (lost) return;
    counts_.px += d.norm();
    counts_.split += in_two;
    counts_.gaps_px += in_two ? gap_px : 0;
    if (!in_two) {
      add_segment(T, a, b, scale, draw, view);
      return;
    }
    const Eigen::Vector2d half_gap = 0.5 * gap_px * d.normalized();
    add_segment(T, a, a + 0.5 * d - half_gap, scale, draw, view);
    add_segment(T, a + 0.5 * d + half_gap, b, scale, draw, view);
  }

  void add_segment(const Pose& T,
                   Eigen::Vector2d a,
                   Eigen::Vector2d b,
                   double scale,
                   vernier::internal::RandomStream& draw,
                   sim::internal::SequenceView& view) const {
    const Eigen::Vector2d t = (b - a).normalized(), n(-t.y(), t.x());
    sim::internal::SequenceSegment segment;
    segment.in_space.covariance_m2.setZero();
    for (int end = 0; end < 2; ++end) {
      Eigen::Vector2d& px = end == 0 ? a : b;
      const double z = scale * depth_at(T, px) + sigma_z_m * draw.normal();
      px += errors_.across_px * draw.normal() * n;
      px += errors_.along_px * draw.normal() * t;
      const Eigen::Vector3d ray((px.x() - 319.5) / 500, (px.y() - 239.5) / 500, 1);
      (end == 0 ? segment.in_space.a_m : segment.in_space.b_m) = z * ray;
      Eigen::Matrix3d C = Eigen::Matrix3d::Zero();
      C.topLeftCorner<2, 2>() = z * z / 250000 *
                                (errors_.across_px * errors_.across_px * n * n.transpose() +
                                 errors_.along_px * errors_.along_px * t * t.transpose());
      C += sigma_z_m * sigma_z_m * ray * ray.transpose();
      segment.in_space.covariance_m2.block<3, 3>(3 * end, 3 * end) = C;
    }
    segment.image_px = {a, b};
    view.segments.push_back(segment);
  }

  static constexpr double sigma_z_m = 0.01;
  MadeErrors errors_;
  std::uint32_t trial_;
  Camera camera_;
  std::vector<Line> lines_;
  Counts counts_;
  std::vector<Pose> true_poses_;
  std::vector<sim::internal::SequenceView> views_;
};

}  // namespace vernier::test
