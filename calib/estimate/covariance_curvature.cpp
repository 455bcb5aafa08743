// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/covariance_curvature.h"

#include <fmt/format.h>

#include <limits>

#include "calib/covariance.h"
#include "calib/estimate/stable_coordinates.h"
#include "calib/rig.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "calib/statistics/scaled_root.h"

namespace vernier::internal {
namespace {

constexpr int draws = 64;

}  // namespace

double covariance_curvature(const Rig& rig, const Covariance& covariance) {
  const StableCoordinates about(rig, covariance.matrix);
  const ScaledRoot root(covariance.matrix);
  const auto q = static_cast<int>(root.white.rows());
  if (q == 0) return 0;
  double sum = 0;
  for (int i = 0; i < draws; ++i) {
    RandomStream random({.trial = static_cast<std::uint32_t>(i),
                         .source = static_cast<std::uint32_t>(DrawSource::curvature)});
    const Eigen::VectorXd delta = root.root * random.normals(q);
    const auto moved = about.try_rig(delta);
    const auto found = moved ? about.try_coordinates(moved->rig) : std::nullopt;
    if (!found) return std::numeric_limits<double>::infinity();
    sum += (root.white * (*found - delta)).squaredNorm();
  }
  return sum / (static_cast<double>(draws) * q);
}

std::optional<std::string> curvature_warning(const Rig& rig, const Covariance& covariance) {
  const double curvature = covariance_curvature(rig, covariance);
  if (curvature <= largest_curvature) return std::nullopt;
  return fmt::format(
      "the rig is known so badly that no covariance describes its errors (curvature {:.2g}, {:g} "
      "at most): standard deviations and sampled rigs are rough; use a lens model with fewer "
      "parameters, a prior of the lens, or views that fill the image at different distances and "
      "larger angles",
      curvature, largest_curvature);
}

}  // namespace vernier::internal
