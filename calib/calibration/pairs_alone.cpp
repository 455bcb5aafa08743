// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/pairs_alone.h"

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "calib/joint_calibration.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"

namespace vernier::internal {
namespace {

/// Whether one solution explains the pairs far better than another: fewer of them are left out, or
/// with less noise.
bool fits_better(const PairsAlone& one, const PairsAlone& other) {
  constexpr double less_noise = 0.8, fewer = 0.1;
  return one.joint.pair_sigma_scale < less_noise * other.joint.pair_sigma_scale ||
         one.left_out_share() < other.left_out_share() - fewer;
}

}  // namespace

GaussianRigPrior loosened(const GaussianRigPrior& known, double wider, Loosened what) {
  GaussianRigPrior loose = known;
  if (what == Loosened::all) {
    loose.covariance.matrix *= wider * wider;
    return loose;
  }
  const std::vector<std::string> all = parameter_names(known.rig);
  const std::set<std::string> poses(all.begin() + pose_index(known.rig, 1), all.end());
  std::vector<Eigen::Index> moved;
  for (std::size_t i = 0; i < known.covariance.names.size(); ++i) {
    if (poses.contains(known.covariance.names[i])) moved.push_back(static_cast<Eigen::Index>(i));
  }
  loose.covariance.matrix(moved, moved) *= wider * wider;
  return loose;
}

PairsAlone pairs_alone(const PairObservations& pairs,
                       const GaussianRigPrior& before,
                       const JointOptions& options,
                       Loosened what) {
  constexpr double loose = 10, hardly_held = 1000;
  const auto solved = [&](double wider) -> PairsAlone {
    JointEvidence evidence;
    evidence.priors.push_back(loosened(before, wider, what));
    evidence.pairs = pairs;
    return {calibrate_jointly(evidence, before.rig, options), pairs.size(), wider};
  };
  const auto if_determined = [&](double wider) -> std::optional<PairsAlone> {
    try {
      return solved(wider);
    } catch (const Error&) {  // the pairs do not determine the rig under so wide a prior
      return {};
    }
  };
  std::optional<PairsAlone> alone = if_determined(loose);
  std::optional<PairsAlone> free = if_determined(hardly_held);
  if (free && (!alone || fits_better(*free, *alone))) alone = std::move(free);
  return alone ? *alone : solved(1);
}

}  // namespace vernier::internal
