// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/covariance.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"

namespace vernier::test {

using namespace vernier::internal;

/// What a datasheet might say of a `radial1` pair: standard deviations of its 16 parameters, which
/// leave a vertical disparity of 15 px.
inline Eigen::VectorXd datasheet_sd() {
  Eigen::VectorXd sd(16);
  sd << 10, 0.002, 8, 8, 0.02, 10, 0.002, 8, 8, 0.02, 0.01, 0.01, 0.01, 0.002, 0.002, 0.002;
  return sd;
}

/// That knowledge with its mean drawn about the truth.
inline GaussianRigPrior datasheet(const Rig& truth,
                                  std::uint64_t seed,
                                  std::uint32_t trial,
                                  double scale = 1) {
  const Eigen::VectorXd sd = scale * datasheet_sd();
  RandomStream draws({.seed = seed,
                      .trial = trial,
                      .source = static_cast<std::uint32_t>(DrawSource::noisy_copy),
                      .frame = 1});
  GaussianRigPrior known{retract(truth, sd.cwiseProduct(draws.normals(16))),
                         {CovarianceKind::prior, parameter_names(truth), {}}};
  known.covariance.matrix = sd.cwiseAbs2().asDiagonal();
  return known;
}

}  // namespace vernier::test
