// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/validation/held_out_boards.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "calib/board_observations.h"
#include "calib/calibrate.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/shuffled.h"
#include "calib/triangulation.h"
#include "calib/validation/board_lengths.h"

namespace vernier::internal {
namespace {

/// Sums for one kind of length.
struct Tally {
  int n = 0, in_honest = 0, in_mvb = 0;
  double z2_honest = 0, z2_mvb = 0, error2 = 0, honest2 = 0, mvb2 = 0;

  void add(double error, double variance_honest, double variance_mvb) {
    constexpr double z_95 = 1.959963984540054;
    ++n;
    const double z2h = error * error / variance_honest, z2m = error * error / variance_mvb;
    in_honest += z2h <= z_95 * z_95;
    in_mvb += z2m <= z_95 * z_95;
    z2_honest += z2h;
    z2_mvb += z2m;
    error2 += error * error;
    honest2 += variance_honest;
    mvb2 += variance_mvb;
  }

  LengthCoverage coverage() const {
    const double m = std::max(n, 1);
    return {n,
            in_honest / m,
            in_mvb / m,
            std::sqrt(z2_honest / m),
            std::sqrt(z2_mvb / m),
            std::sqrt(error2 / m),
            std::sqrt(honest2 / m),
            std::sqrt(mvb2 / m)};
  }
};

/// A length, or a mean of several, with its derivatives with respect to the rig and the pixels of
/// corners.
struct MeasuredValue {
  double value = 0;
  Eigen::RowVectorXd by_rig;
  std::map<int, Eigen::RowVector4d> by_pixels;

  double variance(const Eigen::MatrixXd& C, double pixel_sigma_px) const {
    double pixels = 0;
    for (const auto& [id, J] : by_pixels) pixels += J.squaredNorm();
    return by_rig * C * by_rig.transpose() + pixel_sigma_px * pixel_sigma_px * pixels;
  }
};

MeasuredValue length(const PointTriangulation& a,
                     const PointTriangulation& b,
                     std::pair<int, int> ids) {
  const Eigen::Vector3d d = b.x_m - a.x_m;
  const Eigen::RowVector3d unit = d.transpose() / d.norm();
  MeasuredValue m{d.norm(), unit * (b.by_rig - a.by_rig), {}};
  m.by_pixels[ids.first] = -unit * a.by_pixels;
  m.by_pixels[ids.second] = unit * b.by_pixels;
  return m;
}

/// The corners that can be triangulated, by id.
std::map<int, PointTriangulation> points_of(const Rig& rig, const SeenPair& seen) {
  std::map<int, PointTriangulation> points;
  for (const auto& [id, pixels] : seen) {
    if (const auto point = triangulate_point_with_jacobian(rig, pixels)) points.emplace(id, *point);
  }
  return points;
}

/// Adds one held-out board, by its triangulated corners, to the tallies.
void evaluate_board(const RigEstimate& estimate,
                    const std::vector<Eigen::Vector3d>& target_m,
                    const std::map<int, PointTriangulation>& points,
                    Tally& edges,
                    Tally& scale) {
  const Eigen::MatrixXd &honest = estimate.covariance->matrix, &mvb = *estimate.covariance_mvb;
  const double sigma = estimate.calibration->pixel_sigma_px;
  std::vector<int> ids;
  for (const auto& [id, point] : points) ids.push_back(id);
  const auto pairs = board_edges(target_m, ids);
  MeasuredValue mean{0, Eigen::RowVectorXd::Zero(honest.rows()), {}};
  for (const auto& ends : pairs) {
    const double truth = (target_m[ends.first] - target_m[ends.second]).norm();
    const MeasuredValue m = length(points.at(ends.first), points.at(ends.second), ends);
    edges.add(m.value - truth, m.variance(honest, sigma), m.variance(mvb, sigma));
    const double weight = 1 / (truth * static_cast<double>(pairs.size()));
    mean.value += weight * m.value;
    mean.by_rig += weight * m.by_rig;
    for (const auto& [id, J] : m.by_pixels) {
      mean.by_pixels.try_emplace(id, Eigen::RowVector4d::Zero()).first->second += weight * J;
    }
  }
  scale.add(mean.value - 1, mean.variance(honest, sigma), mean.variance(mvb, sigma));
}

}  // namespace

HeldOutBoardsResult evaluate_held_out_boards(
    const BoardObservations& observations,
    const HeldOutBoardsOptions& options,
    const std::function<void(int done, int total)>& progress) {
  const std::vector<int> frames = frames_of(observations);
  if (observations.size_px.size() < 2 || frames.size() < fewest_frames_to_divide) {
    throw Error("boards left out", "needs a pair of cameras and at least six frames",
                "give more views");
  }
  const auto n = static_cast<int>(frames.size());
  const int training = options.training_frames > 0 ? options.training_frames : n / 2 + 1;
  if (training < 3 || training >= n) {
    throw Error("boards left out",
                std::to_string(training) + " training frames of " + std::to_string(n),
                "give at least 3, and fewer than there are");
  }
  const std::vector<SeenPair> seen = seen_pairs(observations, frames);
  Tally edges, scale;
  HeldOutBoardsResult result;
  result.training_frames = training;
  for (int split = 0; split < options.splits; ++split) {
    std::vector<int> kept =
        shuffled(frames, {.seed = options.seed,
                          .trial = static_cast<std::uint32_t>(split),
                          .source = static_cast<std::uint32_t>(DrawSource::left_out_boards)});
    kept.resize(static_cast<std::size_t>(training));
    std::sort(kept.begin(), kept.end());
    try {
      const RigEstimate estimate = calibrate(at_frames(observations, kept), options.calibration);
      ++result.splits;
      for (int f = 0; f < n; ++f) {
        if (seen[f].size() < 4 || std::binary_search(kept.begin(), kept.end(), frames[f])) continue;
        const auto points = points_of(estimate.rig, seen[f]);
        result.corners_left_out += static_cast<int>(seen[f].size() - points.size());
        ++(points.size() < 4 ? result.boards_left_out : result.boards);
        if (points.size() < 4) continue;
        evaluate_board(estimate, observations.target_m, points, edges, scale);
      }
    } catch (const Error&) {
      ++result.failed;  // these frames alone do not determine the rig
    }
    if (progress) progress(split + 1, options.splits);
  }
  if (result.boards == 0) {
    throw Error("boards left out", "no split could be calibrated and evaluated",
                "give more views, or a model with fewer parameters");
  }
  result.edges = edges.coverage();
  result.scale = scale.coverage();
  return result;
}

}  // namespace vernier::internal
