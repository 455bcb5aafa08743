// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/sampler.h"

#include <fmt/format.h>

#include <memory>
#include <string>

#include "calib/error.h"
#include "calib/estimate/covariance_check.h"
#include "calib/estimate/stable_coordinates.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"

namespace vernier {

using namespace internal;

namespace {

[[noreturn]] void throw_overflow(const std::string& place, double psi_c) {
  throw Error(
      place,
      fmt::format("at psi_c = {} its standard deviations exceed the range of numbers", psi_c),
      "give a smaller psi_c, or correct the covariance");
}

}  // namespace

RigSampler::RigSampler(const RigEstimate& estimate, const std::string& place)
    : place_(place), mean_(estimate.rig), decomposition_(required_covariance(estimate, place)) {
  check_names(*estimate.covariance, mean_, place);
  coordinates_ = std::make_shared<const StableCoordinates>(mean_, estimate.covariance->matrix);
}

Eigen::VectorXd RigSampler::deviation(double psi_c, std::uint64_t seed, std::uint32_t trial) const {
  if (!(psi_c >= 0)) {
    throw Error(place_, fmt::format("psi_c = {} is not a factor on standard deviations", psi_c),
                "give 0 or more");
  }
  RandomStream draws({.seed = seed,
                      .trial = trial,
                      .source = static_cast<std::uint32_t>(DrawSource::calibration)});
  const Eigen::MatrixXd& factor = decomposition_.factor();
  const Eigen::VectorXd unit = factor * draws.normals(static_cast<int>(factor.cols()));
  Eigen::VectorXd moved = psi_c * unit;
  if (!moved.allFinite()) throw_overflow(place_, psi_c);
  return moved;
}

Rig RigSampler::sample(double psi_c, std::uint64_t seed, std::uint32_t trial) const {
  Rig rig = moved(deviation(psi_c, seed, trial)).rig;
  if (!parameters(rig).allFinite()) throw_overflow(place_, psi_c);
  return rig;
}

MovedRig RigSampler::moved(const Eigen::VectorXd& deviation) const {
  return coordinates_->rig(deviation);
}

}  // namespace vernier
