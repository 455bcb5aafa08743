// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/rig_estimate.h"

#include <algorithm>
#include <set>

#include "calib/base/shown_text.h"
#include "calib/camera.h"
#include "calib/camera/rig_limits.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/estimate/held_parameters.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"

namespace vernier {

using namespace internal;

const Covariance& required_covariance(const RigEstimate& estimate, const std::string& place) {
  if (!estimate.covariance) {
    throw Error(place, "the rig has no covariance to sample from",
                "calibrate it with vernier calibrate, or add parameter_names, parameters and "
                "covariance by hand");
  }
  return *estimate.covariance;
}

std::optional<Covariance> chosen_covariance(const RigEstimate& estimate, CovarianceChoice choice) {
  if (choice == CovarianceChoice::honest) return estimate.covariance;
  if (estimate.covariance_mvb) {
    return Covariance{CovarianceKind::mvb, parameter_names(estimate.rig), *estimate.covariance_mvb};
  }
  if (estimate.covariance && estimate.covariance->kind == CovarianceKind::mvb) {
    return estimate.covariance;
  }
  return std::nullopt;
}

Covariance required_covariance(const RigEstimate& estimate,
                               CovarianceChoice choice,
                               const std::string& place) {
  if (choice == CovarianceChoice::honest) return required_covariance(estimate, place);
  const std::optional<Covariance> chosen = chosen_covariance(estimate, choice);
  if (!chosen) {
    throw Error(place, "it has no minimum variance bound", "use the covariance it has");
  }
  return *chosen;
}

std::vector<bool> held_parameters(const RigEstimate& estimate) {
  const Rig& rig = estimate.rig;
  const std::vector<std::string> names = parameter_names(rig);
  std::vector<bool> held(names.size(), false);
  if (!estimate.covariance) return held;
  held = without_variance(rig, estimate.covariance->matrix);
  if (!estimate.calibration) return held;
  for (const std::string& name : estimate.calibration->held) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) held[static_cast<std::size_t>(found - names.begin())] = true;
  }
  return held;
}

GaussianRigPrior gaussian_prior_of(const RigEstimate& estimate, const std::string& place) {
  const Covariance& all = required_covariance(estimate, place);
  const std::vector<bool> held = held_parameters(estimate);
  return {estimate.rig,
          {all.kind, free_names(estimate.rig, held),
           covariance_of_free(all.matrix, estimate.rig, held)}};
}

void rename_cameras(RigEstimate& estimate, const std::vector<std::string>& names) {
  Rig& rig = estimate.rig;
  if (names.size() != rig.cameras.size()) {
    throw Error("names of cameras",
                std::to_string(names.size()) + " names for " + std::to_string(rig.cameras.size()) +
                    " cameras",
                "give one per camera");
  }
  const std::set<std::string> different(names.begin(), names.end());
  if (different.size() != names.size() || different.count("")) {
    throw Error("names of cameras", "two cameras have the same name, or one has none",
                "give each its own name");
  }
  for (const std::string& name : names) {
    if (is_camera_name(name)) continue;
    throw Error("names of cameras",
                in_quotes(name) + " is longer than 100 bytes, not on one line or not UTF-8",
                "shorten it");
  }
  const std::vector<std::string> before = parameter_names(rig);
  std::vector<std::string> cameras_before;
  for (const Camera& camera : rig.cameras) cameras_before.push_back(camera.name);
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
  if (!estimate.evidence) return;
  for (GaussianRigPrior& prior : estimate.evidence->priors) {  // it may have fewer cameras
    for (Camera& camera : prior.rig.cameras) {
      const auto was = std::find(cameras_before.begin(), cameras_before.end(), camera.name);
      if (was != cameras_before.end()) camera.name = names[was - cameras_before.begin()];
    }
    rename_all(prior.covariance.names);
  }
}

}  // namespace vernier
