// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/uncertainty/sampled_propagation.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/estimate/stable_coordinates.h"
#include "calib/interval.h"
#include "calib/pose.h"
#include "calib/projection_uncertainty.h"
#include "calib/rig.h"
#include "calib/rig_and_boards.h"
#include "calib/sampler.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/quantile.h"
#include "calib/statistics/random.h"
#include "calib/triangulation.h"
#include "calib/triangulation_uncertainty.h"
#include "calib/uncertainty/pose_covariance.h"

namespace vernier::internal {
namespace {

/// First and second moments of the physical draws about a fixed value.
template <int N>
struct Moments {
  using Vector = Eigen::Matrix<double, N, 1>;
  Vector sum = Vector::Zero();
  Eigen::Matrix<double, N, N> squares = Eigen::Matrix<double, N, N>::Zero();
  int count = 0;

  void add(const Vector& deviation) {
    sum += deviation;
    squares += deviation * deviation.transpose();
    ++count;
  }
  Vector mean() const {
    return count > 0 ? Vector(sum / count)
                     : Vector(Vector::Constant(std::numeric_limits<double>::quiet_NaN()));
  }
  Eigen::Matrix<double, N, N> covariance() const {
    if (count < 2) {
      return Eigen::Matrix<double, N, N>::Constant(std::numeric_limits<double>::quiet_NaN());
    }
    const Vector m = mean();
    return (squares - count * m * m.transpose()) / (count - 1);
  }
  double missing_share(int samples) const { return 1 - static_cast<double>(count) / samples; }
};

void check(const SamplingOptions& options, bool needs_boards, bool has_boards) {
  if (options.samples < 2) {
    throw Error("sampled propagation", "fewer than 2 samples", "give more");
  }
  if (needs_boards && !has_boards) {
    throw Error("sampled propagation", "a point fixed to the boards needs their poses",
                "calibrate with evidence, or fix the point to a camera");
  }
}

/// The position, in the frame of `drawn`, of the point that is at `point` in the frame of `told`.
Eigen::Vector3d carried(const Pose& told,
                        const Pose& drawn,
                        const FixedPoint& point,
                        PointFixedTo fixed_to,
                        const MeanBoardMap& map) {
  if (fixed_to == PointFixedTo::camera) return point.x_camera;
  if (point.at_infinity) {
    Eigen::Vector3d d = told.R.transpose() * point.x_camera;
    if (fixed_to == PointFixedTo::boards) d = map.A * d;
    return drawn.R * d;
  }
  Eigen::Vector3d x = told.inverse() * point.x_camera;
  if (fixed_to == PointFixedTo::boards) x = map.A * x + map.b;
  return drawn * x;
}

Eigen::Vector4d pair_noise(const SamplingOptions& options, std::uint32_t trial) {
  RandomStream draws({.seed = options.seed,
                      .trial = trial,
                      .source = static_cast<std::uint32_t>(DrawSource::monte_carlo),
                      .frame = 1});
  return draws.normals(4);
}

}  // namespace

std::vector<SampledPixel> sampled_projection(const RigSampler& sampler,
                                             const std::optional<RigAndBoards>& boards,
                                             int camera,
                                             PointFixedTo fixed_to,
                                             std::span<const FixedPoint> points,
                                             const SamplingOptions& options) {
  const bool by_boards = fixed_to == PointFixedTo::boards;
  check(options, by_boards, boards.has_value());
  const Rig& told = sampler.mean();
  if (camera < 0 || camera >= static_cast<int>(told.cameras.size())) {
    throw Error("sampled propagation", "the rig has no such camera", "count cameras from 0");
  }
  std::vector<Moments<2>> moments(points.size());
  MeanBoardMap map{Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()};
  for (int i = 0; i < options.samples; ++i) {
    const auto trial = static_cast<std::uint32_t>(i);
    const Eigen::VectorXd deviation = sampler.deviation(options.psi_c, options.seed, trial);
    const MovedRig moved = sampler.moved(deviation);
    const Rig& drawn = moved.rig;
    if (by_boards) {
      map = sample_board_map(*boards, deviation, moved, options.psi_c, options.seed, trial);
    }
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Eigen::Vector3d x = carried(told.T_camera_first[camera], drawn.T_camera_first[camera],
                                        points[k], fixed_to, map);
      const auto q = try_project(drawn.cameras[camera], x);
      if (q) moments[k].add(*q - project(told.cameras[camera], points[k].x_camera));
    }
  }
  std::vector<SampledPixel> result;
  result.reserve(moments.size());
  for (const Moments<2>& m : moments) {
    result.push_back({m.mean(), m.covariance(), m.missing_share(options.samples)});
  }
  return result;
}

std::vector<SampledPoint> sampled_triangulation(const RigSampler& sampler,
                                                const std::optional<RigAndBoards>& boards,
                                                TriangulationFrame frame,
                                                std::span<const PixelPair> pairs,
                                                double pair_sigma_px,
                                                const SamplingOptions& options,
                                                int other) {
  const bool stabilised = frame == TriangulationFrame::stabilised;
  check(options, stabilised, boards.has_value());
  std::vector<Eigen::Vector3d> told;
  for (const PixelPair& pair : pairs) {
    const auto x = triangulate_point(sampler.mean(), pair, other);
    if (!x) {
      throw Error("sampled propagation", "a pixel pair cannot be triangulated with the rig itself",
                  "give pixels whose rays meet in front of the rig");
    }
    told.push_back(*x);
  }
  std::vector<Moments<3>> moments(pairs.size());
  std::vector<std::vector<double>> depths(pairs.size());
  for (int i = 0; i < options.samples; ++i) {
    const auto trial = static_cast<std::uint32_t>(i);
    const Eigen::VectorXd deviation = sampler.deviation(options.psi_c, options.seed, trial);
    const MovedRig moved = sampler.moved(deviation);
    const Rig& drawn = moved.rig;
    const Eigen::Vector4d noise = pair_sigma_px * pair_noise(options, trial);
    MeanBoardMap map{Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()};
    if (stabilised) {
      map = sample_board_map(*boards, deviation, moved, options.psi_c, options.seed, trial);
    }
    const Eigen::Matrix3d back = map.A.inverse();
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      auto x = triangulate_point(
          drawn, {pairs[k].first_px + noise.head<2>(), pairs[k].other_px + noise.tail<2>()}, other);
      if (x && stabilised) x = back * (*x - map.b);
      const bool physical = x && x->z() > 0 && x->allFinite();
      if (physical) moments[k].add(*x - told[k]);
      depths[k].push_back(physical ? x->z() : std::numeric_limits<double>::infinity());
    }
  }
  std::vector<SampledPoint> result;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    std::sort(depths[k].begin(), depths[k].end());
    result.push_back({moments[k].mean(), moments[k].covariance(), interval_95(depths[k]),
                      moments[k].missing_share(options.samples)});
  }
  return result;
}

Interval interval_95(const std::vector<double>& sorted) {
  return {quantile(sorted, 0.025, QuantileKind::linear),
          quantile(sorted, 0.975, QuantileKind::linear)};
}

}  // namespace vernier::internal
