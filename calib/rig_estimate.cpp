// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/rig_estimate.h"

#include <algorithm>
#include <set>

#include "calib/error.h"

namespace vernier {

const Covariance& required_covariance(const RigEstimate& estimate, const std::string& place) {
  if (!estimate.covariance) {
    throw Error(place, "the rig has no covariance, so there is nothing to sample from",
                "calibrate it with vernier calibrate, or add parameter_names, parameters and "
                "covariance by hand");
  }
  return *estimate.covariance;
}

std::vector<Eigen::Index> free_parameters(const RigEstimate& estimate) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < parameter_count(estimate.rig); ++i) {
    if (!estimate.covariance || estimate.covariance->matrix(i, i) > 0) free.push_back(i);
  }
  return free;
}

void rename_cameras(RigEstimate& estimate, const std::vector<std::string>& names) {
  Rig& rig = estimate.rig;
  if (names.size() != rig.cameras.size()) {
    throw Error("names of cameras",
                std::to_string(names.size()) + " names for " + std::to_string(rig.cameras.size()) +
                    " cameras",
                "give one a camera");
  }
  const std::set<std::string> different(names.begin(), names.end());
  if (different.size() != names.size() || different.count("")) {
    throw Error("names of cameras", "two cameras have one name, or one has none",
                "name each its own");
  }
  const std::vector<std::string> before = parameter_names(rig);
  for (std::size_t i = 0; i < names.size(); ++i) rig.cameras[i].name = names[i];
  const std::vector<std::string> after = parameter_names(rig);
  const auto rename_all = [&](std::vector<std::string>& listed) {
    for (std::string& name : listed) {
      const auto found = std::find(before.begin(), before.end(), name);
      if (found != before.end()) name = after[static_cast<std::size_t>(found - before.begin())];
    }
  };
  if (estimate.covariance) rename_all(estimate.covariance->names);
  if (estimate.calibration) rename_all(estimate.calibration->held);
}

}  // namespace vernier
