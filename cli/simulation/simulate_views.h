// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "cli/program/namespaces.h"
#include "cli/program/session.h"
#include "cli/simulation/floor_poses.h"
#include "localise/place.h"
#include "localise/views/edge_depths.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/visibility.h"

namespace vernier::cli {

/// What `simulate --poses` adds to `simulate`: views of a camera with depth maps.
struct SimulatedViewOptions {
  FloorPoseOptions at;
  double depth_per_m2 = DepthNoise{}.per_m2;
  std::string output, segments;
  PlaceLineOptions lines;
};

/// Simulates the view of each pose and writes all as `lines` does. Every view has draws of its own:
/// its number is that of the frame. `world` is the file of the world, which stays as it is.
void simulate_views(const Visibility& visibility,
                    const std::filesystem::path& world,
                    const std::string& rig_name,
                    const SourceSettings& sources,
                    const SensingDraw& draw,
                    const SimulatedViewOptions& options,
                    Session& session);

}  // namespace vernier::cli
