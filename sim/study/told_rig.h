// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/rig.h"
#include "sim/experiment.h"
#include "sim/sense.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

/// The end-point error that the estimator reckons with: 0.15 px, or max(0.1 px, psi_g) where it
/// knows psi_g.
double told_endpoint_sigma_px(const ExperimentSettings& settings);

/// The sensed segments in space, in the left camera's frame of the rig that the estimator is told.
std::vector<stereo::SpaceSegment> reconstruct(const Rig& told,
                                              const StereoObservation& sighting,
                                              const ExperimentSettings& settings);

}  // namespace vernier::sim::internal
