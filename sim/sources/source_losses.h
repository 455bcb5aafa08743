// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "sim/noise_free_view.h"
#include "sim/sense.h"

namespace vernier::sim::internal {

using SpaceEdge = std::pair<Eigen::Vector3d, Eigen::Vector3d>;  ///< true left camera frame, metres

/// What a source did to the edges that those before it left.
struct SourceLosses {
  std::string source;
  std::vector<SpaceEdge> lost;       ///< parts of edges that stereo does not get any more
  std::vector<SpaceEdge> displaced;  ///< by 2 px or more at an end in one of the images
  std::vector<SpaceEdge> added;      ///< that nothing in the world explains
};

struct SensedEdges {
  std::vector<SpaceEdge> told;  ///< what stereo gets, where it truly is
  std::vector<SourceLosses> sources;
};

/// What a sensor gets of a view, and what each of its sources took away on the way there. Throws
/// Error where a source fails.
SensedEdges source_losses(const Sensor& sensor, const NoiseFreeView& view, const SensingDraw& draw);

}  // namespace vernier::sim::internal
