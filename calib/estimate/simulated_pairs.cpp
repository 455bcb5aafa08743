// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/simulated_pairs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"

namespace vernier::internal {
namespace {

constexpr auto pair_source = static_cast<std::uint32_t>(DrawSource::simulated_pairs);

/// A point seen by the left camera, in its frame: on the plane of `normal` (n·X = 1), or anywhere.
Eigen::Vector3d draw_point(RandomStream& draws,
                           const Camera& camera,
                           const Eigen::Vector3d& normal,
                           const SimulatedPairsOptions& options) {
  const double y = draws.uniform(0, camera.size_px[1] - 1);
  const double x = draws.uniform(0, camera.size_px[0] - 1);
  const Eigen::Vector3d ray = unproject(camera, {x, y});
  const double inverse_z = draws.uniform(1 / options.farthest_m, 1 / options.nearest_m);
  if (options.scene == SimulatedScene::plane) return ray / normal.dot(ray);
  return ray / inverse_z;
}

bool well_inside(const Camera& camera, const Eigen::Vector2d& pixel, double border_px) {
  return (pixel.array() >= border_px).all() &&
         (pixel.array() <= camera.size_px.cast<double>().array() - 1 - border_px).all();
}

/// The plane of an image pair as a vector n with n·X = 1 on it.
Eigen::Vector3d draw_plane(std::uint64_t seed, const SimulatedPairsOptions& options) {
  RandomStream draws({.seed = seed, .source = pair_source, .eye = 2});
  const double inverse_z = 0.5 * (1 / options.farthest_m + 1 / options.nearest_m);
  const double y = draws.uniform(-0.3, 0.3), x = draws.uniform(-0.3, 0.3);
  return inverse_z * Eigen::Vector3d(x, y, 1);
}

/// The pixels of a point that both cameras see.
Eigen::Vector4d draw_pair(const Rig& rig,
                          std::uint64_t seed,
                          std::uint32_t image,
                          std::uint32_t match,
                          const Eigen::Vector3d& normal,
                          const SimulatedPairsOptions& options) {
  const double border = std::max(3.0, 6 * options.pixel_sigma_px) +
                        (options.wrong_share > 0 ? options.wrong_radius_px : 0);
  RandomStream draws(
      {.seed = seed, .feature = match, .source = pair_source, .eye = 3, .frame = image});
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const Eigen::Vector3d X = draw_point(draws, rig.cameras[0], normal, options);
    const Eigen::Vector3d right = rig.T_camera_first[1] * X;
    if (!(X.z() > 0.05 && right.z() > 0.05)) continue;
    Eigen::Vector4d y;
    y << project(rig.cameras[0], X), project(rig.cameras[1], right);
    if (well_inside(rig.cameras[0], y.head<2>(), border) &&
        well_inside(rig.cameras[1], y.tail<2>(), border)) {
      return y;
    }
  }
  throw Error("simulated pairs", "the cameras do not see the same space at these depths",
              "use other depths");
}

void disturb(Eigen::Vector4d& y,
             std::uint64_t seed,
             std::uint32_t trial,
             std::uint32_t image,
             std::uint32_t match,
             const SimulatedPairsOptions& options) {
  RandomStream draws(
      {.seed = seed, .trial = trial, .feature = match, .source = pair_source, .frame = image});
  y += options.pixel_sigma_px * draws.normals(4);
  if (draws.uniform() >= options.wrong_share) return;
  const double radius = options.wrong_radius_px * std::sqrt(draws.uniform());
  const double angle = draws.uniform(0, 2 * std::numbers::pi);
  y.tail<2>() += radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
}

}  // namespace

PairObservations simulate_pairs(const Rig& rig,
                                std::uint64_t seed,
                                std::uint32_t trial,
                                const SimulatedPairsOptions& options) {
  PairObservations pairs;
  const Eigen::Vector3d normal = draw_plane(seed, options);
  const double sigma = options.pixel_sigma_px > 0 ? options.pixel_sigma_px : 1;
  for (int image = 0; image < options.image_pairs; ++image) {
    for (int match = 0; match < options.pairs_per_image; ++match) {
      const auto i = static_cast<std::uint32_t>(image), m = static_cast<std::uint32_t>(match);
      Eigen::Vector4d y = draw_pair(rig, seed, i, m, normal, options);
      disturb(y, seed, trial, i, m, options);
      add_pair(pairs, image, y, sigma);
    }
  }
  return pairs;
}

}  // namespace vernier::internal
