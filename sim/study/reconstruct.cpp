// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/reconstruct.h"

#include <algorithm>

#include "calib/rig.h"
#include "sim/experiment.h"
#include "sim/sense.h"
#include "stereo/reconstruction/triangulate.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

using namespace stereo;
using namespace stereo::internal;

double told_endpoint_sigma_px(const ExperimentSettings& settings) {
  return settings.knows_endpoint_sigma ? std::max(0.1, settings.sources.endpoint_sigma_px)
                                       : TriangulationOptions().endpoint_sigma_px;
}

std::vector<SpaceSegment> reconstruct(const Rig& told,
                                      const StereoObservation& sighting,
                                      const ExperimentSettings& settings) {
  const TriangulationOptions options{.endpoint_sigma_px = told_endpoint_sigma_px(settings)};
  return triangulate(told, sighting.segments, options);
}

}  // namespace vernier::sim::internal
