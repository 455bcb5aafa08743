// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/localisation/same_rig.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "localise/topological_map.h"

namespace vernier::cli {

namespace {

/// Of the first two cameras; 0 for a single one.
double baseline_m(const Rig& rig) {
  return rig.cameras.size() < 2 ? 0 : rig.T_camera_first[1].t.norm();
}

}  // namespace

void check_same_rig(const TopologicalMap& map, const Rig& rig, const std::string& map_name) {
  constexpr double same_focal_length = 0.05, same_baseline = 0.1;
  for (const MapNode& node : map.nodes) {
    if (!node.view.rig) continue;
    const Camera &a = node.view.rig->cameras[0], &b = rig.cameras[0];
    const double baseline = baseline_m(rig), of_map = baseline_m(*node.view.rig);
    if (a.size_px == b.size_px && std::abs(a.f_px() - b.f_px()) <= same_focal_length * a.f_px() &&
        std::abs(baseline - of_map) <= same_baseline * of_map) {
      return;
    }
    throw Error(map_name,
                fmt::format("was recorded with another rig ({}x{} px, f {:.0f} px, baseline "
                            "{:.3f} m; here {}x{} px, {:.0f} px, {:.3f} m)",
                            a.size_px[0], a.size_px[1], a.f_px(), of_map, b.size_px[0],
                            b.size_px[1], b.f_px(), baseline),
                "record the map with the rig that asks");
  }
}

}  // namespace vernier::cli
