// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/board_tests.h"

#include <Eigen/Geometry>
#include <cstddef>

#include "calib/base/decompositions.h"
#include "calib/board/board_warp.h"
#include "calib/noise/camera_scales.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/fit_corner_noise.h"
#include "calib/noise/noise_of_estimate.h"
#include "calib/noise/restricted_likelihood.h"
#include "calib/noise/scaled_factor.h"
#include "calib/rig_estimate.h"
#include "calib/statistics/distributions.h"

namespace vernier::internal {

std::vector<BoardField> bend_fields(const std::vector<Eigen::Vector3d>& target_m) {
  const Eigen::Matrix<double, Eigen::Dynamic, 2> parabolas = warp_shapes(target_m);
  std::vector<BoardField> fields(3, BoardField::Zero(3, parabolas.rows()));
  Eigen::AlignedBox3d extent;
  for (const Eigen::Vector3d& X : target_m) extent.extend(X);
  const Eigen::Vector3d middle = extent.center();
  const Eigen::Array2d half = 0.5 * extent.sizes().head<2>().array();
  for (Eigen::Index i = 0; i < parabolas.rows(); ++i) {
    const Eigen::Vector3d x = target_m[static_cast<std::size_t>(i)] - middle;
    fields[0](2, i) = parabolas(i, 0);
    fields[1](2, i) = parabolas(i, 1);
    fields[2](2, i) = x.x() * x.y() / half.prod();
  }
  return fields;
}

BoardTest board_test(const RigEstimate& usual, const std::vector<BoardField>& unknowns) {
  const RestrictedLikelihood likelihood = noise_likelihood(
      usual, {.motion = usual.rig.cameras.size() > 1}, unknowns, CameraNoise::of_each);
  const double spacing_m = point_spacing_m(usual.evidence->observations.target_m);
  const NoiseSolution s = fit_corner_noise(likelihood, spacing_m).solution;
  const auto n = static_cast<Eigen::Index>(unknowns.size());
  BoardTest test;
  test.value = s.step.tail(n);
  test.covariance =
      ScaledFactor(s.equations.information, "the rig").inverse().bottomRightCorner(n, n);
  test.chi2 = test.value.dot(solve_symmetric(test.covariance, test.value));
  test.p_value = chi_squared_survival(test.chi2, static_cast<double>(n));
  return test;
}

}  // namespace vernier::internal
