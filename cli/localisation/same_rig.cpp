// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/localisation/same_rig.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

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

/// The largest angle between what the corners of two images of one size look at, degrees. A corner
/// that a lens does not reach counts for none.
double corner_angle_deg(const Camera& a, const Camera& b) {
  const double right = a.size_px[0] - 1, bottom = a.size_px[1] - 1;
  double largest = 0;
  for (const auto& [u, v] : {std::pair{0.0, 0.0}, {right, 0.0}, {0.0, bottom}, {right, bottom}}) {
    const auto of_a = try_unproject(a, {u, v}), of_b = try_unproject(b, {u, v});
    if (!of_a || !of_b) continue;
    largest = std::max(largest, std::atan2(of_a->cross(*of_b).norm(), of_a->dot(*of_b)));
  }
  return largest * 180 / std::numbers::pi;
}

/// How the rig that asks differs from a map's by more than a new calibration would; empty if not.
std::string how_other(const Rig& of_map, const Rig& asks) {
  constexpr double same_focal_length = 0.05, same_baseline = 0.1, same_corners_deg = 5;
  const Camera &a = of_map.cameras[0], &b = asks.cameras[0];
  const double a_m = baseline_m(of_map), b_m = baseline_m(asks);
  if (a.size_px != b.size_px || std::abs(a.f_px() - b.f_px()) > same_focal_length * a.f_px() ||
      std::abs(a_m - b_m) > same_baseline * a_m) {
    return fmt::format(
        "another rig ({}x{} px, f {:.0f} px, baseline {:.3f} m; here {}x{} px, {:.0f} px, {:.3f} "
        "m)",
        a.size_px[0], a.size_px[1], a.f_px(), a_m, b.size_px[0], b.size_px[1], b.f_px(), b_m);
  }
  const double corners_deg = corner_angle_deg(a, b);
  if (corners_deg <= same_corners_deg) return "";
  return fmt::format("another lens (corners of the image look up to {:.0f} degrees elsewhere)",
                     corners_deg);
}

}  // namespace

void check_same_rig(const TopologicalMap& map, const Rig& rig, const std::string& map_name) {
  const auto first = std::find_if(map.nodes.begin(), map.nodes.end(),
                                  [](const MapNode& node) { return node.view.rig != nullptr; });
  if (first == map.nodes.end()) return;
  const std::string other = how_other(*first->view.rig, rig);
  if (other.empty()) return;
  throw Error(map_name, "was recorded with " + other, "record the map with the rig that asks");
}

void check_one_rig(const Rig& first,
                   const Rig& rig,
                   const std::string& file,
                   const std::string& view) {
  const std::string other = how_other(first, rig);
  if (other.empty()) return;
  throw Error(file, view + ": those before were taken with " + other, "make a map for each rig");
}

}  // namespace vernier::cli
