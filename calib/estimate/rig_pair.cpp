// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/rig_pair.h"

#include <string>
#include <vector>

#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"

namespace vernier::internal {

RigEstimate pair_of(const RigEstimate& estimate, int other) {
  const Rig& rig = estimate.rig;
  if (other < 1 || other >= static_cast<int>(rig.cameras.size())) {
    throw Error("rig",
                "no camera " + std::to_string(other) + " to pair with the first: it has " +
                    std::to_string(rig.cameras.size()),
                "count cameras from 0");
  }
  RigEstimate pair;
  pair.rig.cameras = {rig.cameras[0], rig.cameras[other]};
  pair.rig.T_camera_first = {rig.T_camera_first[0], rig.T_camera_first[other]};
  std::vector<Eigen::Index> rows;
  const auto append = [&](int first, int count) {
    for (int i = 0; i < count; ++i) rows.push_back(first + i);
  };
  append(0, parameter_count(rig.cameras[0].model));
  append(intrinsics_index(rig, other), parameter_count(rig.cameras[other].model));
  append(pose_index(rig, other), 6);
  if (estimate.covariance) {
    pair.covariance = Covariance{estimate.covariance->kind, parameter_names(pair.rig),
                                 estimate.covariance->matrix(rows, rows)};
  }
  if (estimate.covariance_mvb) pair.covariance_mvb = (*estimate.covariance_mvb)(rows, rows);
  pair.calibration = estimate.calibration;
  return pair;
}

}  // namespace vernier::internal
