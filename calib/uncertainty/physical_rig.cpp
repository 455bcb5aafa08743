// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/uncertainty/physical_rig.h"

#include <string>

#include "calib/camera.h"
#include "calib/rig.h"

namespace vernier::internal {

std::string unphysical(const Rig& rig) {
  for (const Camera& camera : rig.cameras) {
    if (!(camera.f_px() > 0)) return camera.name + ".f_px is not positive";
    if (!(camera.ax() > 0)) return camera.name + ".ax is not positive";
  }
  return "";
}

}  // namespace vernier::internal
