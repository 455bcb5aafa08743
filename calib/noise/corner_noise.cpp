// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/corner_noise.h"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "calib/error.h"
#include "calib/rig_estimate.h"

namespace vernier::internal {

CornerNoise noise_of(const CalibrationEffects& effects) {
  return {effects.white_px,      effects.field_px,      effects.field_length_m,
          effects.motion_rad,    effects.motion_m,      effects.motion_baseline_m,
          effects.shape_plane_m, effects.shape_height_m};
}

Eigen::VectorXd motion_sigmas(const CornerNoise& noise, Eigen::Index columns) {
  const double along = noise.motion_baseline_m > 0 ? noise.motion_baseline_m : noise.motion_m;
  Eigen::VectorXd sigmas(columns);
  for (Eigen::Index k = 0; k < columns; ++k) {
    sigmas[k] = k % 6 < 3 ? noise.motion_rad : k % 6 == 3 ? along : noise.motion_m;
  }
  return sigmas;
}

double point_spacing_m(const std::vector<Eigen::Vector3d>& target_m) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < target_m.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      least = std::min(least, (target_m[i] - target_m[j]).norm());
    }
  }
  if (!(least > 0) || target_m.size() < 2) {
    throw Error("board", "needs two points in different places", "check the board's points");
  }
  return least;
}

}  // namespace vernier::internal
