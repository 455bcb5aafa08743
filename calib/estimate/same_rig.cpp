// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/same_rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "calib/board/corner_difference.h"
#include "calib/board_observations.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"

namespace vernier::internal {
namespace {

bool has_image(const CalibrationEvidence& evidence,
               const Rig& rig,
               const BoardView& view,
               const std::string& camera) {
  constexpr double same_image_px = 2;
  const auto& others = evidence.observations.views;
  return std::any_of(others.begin(), others.end(), [&](const BoardView& other) {
    if (rig.cameras[other.camera].name != camera) return false;
    const double rms_px = corner_difference(view, other, same_image_px).rms_px;
    const bool same_name = !view.image.empty() && view.image == other.image;
    return rms_px == 0 || (same_name && rms_px < same_image_px);
  });
}

}  // namespace

void check_same_cameras(const Rig& a, const Rig& b, const std::string& place_b) {
  if (a.cameras.size() != b.cameras.size()) {
    throw Error(place_b,
                fmt::format("it has {} camera{} and the first rig {}", b.cameras.size(),
                            b.cameras.size() == 1 ? "" : "s", a.cameras.size()),
                "compare calibrations of the same cameras");
  }
  for (std::size_t c = 0; c < a.cameras.size(); ++c) {
    const Camera &camera_a = a.cameras[c], &camera_b = b.cameras[c];
    if (camera_a.name != camera_b.name) {
      throw Error(place_b,
                  fmt::format("its camera {} is \"{}\" and that of the first rig \"{}\"", c + 1,
                              camera_b.name, camera_a.name),
                  "give the same cameras the same names and order in both files");
    }
    if (camera_a.size_px != camera_b.size_px) {
      throw Error(place_b,
                  fmt::format("its camera \"{}\" has images of {}x{} and that of the first rig "
                              "{}x{}",
                              camera_b.name, camera_b.size_px[0], camera_b.size_px[1],
                              camera_a.size_px[0], camera_a.size_px[1]),
                  "calibrate both at one image size");
    }
  }
}

int shared_views(const CalibrationEvidence& a,
                 const Rig& rig_a,
                 const CalibrationEvidence& b,
                 const Rig& rig_b) {
  return static_cast<int>(std::count_if(
      a.observations.views.begin(), a.observations.views.end(), [&](const BoardView& view) {
        return has_image(b, rig_b, view, rig_a.cameras[view.camera].name);
      }));
}

}  // namespace vernier::internal
