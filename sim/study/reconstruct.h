// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/rig.h"
#include "sim/experiment.h"
#include "sim/sense.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

/// End-point standard deviation assumed by the estimator: 0.15 px, or max(0.1 px, psi_g) with
/// knows_endpoint_sigma.
double told_endpoint_sigma_px(const ExperimentSettings& settings);

/// Triangulates the sensed segments, in the left camera frame of the rig assumed by the estimator.
std::vector<stereo::SpaceSegment> reconstruct(const Rig& told,
                                              const StereoObservation& sighting,
                                              const ExperimentSettings& settings);

}  // namespace vernier::sim::internal
