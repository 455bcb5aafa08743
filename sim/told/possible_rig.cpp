// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/told/possible_rig.h"

#include <algorithm>
#include <string>

#include "calib/camera.h"
#include "calib/rig.h"
#include "calib/uncertainty/physical_rig.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

bool is_far_outside(const Camera& camera) {
  const double margin_px = camera.size_px.maxCoeff();
  const auto is_far = [&](double centre_px, int size_px) {
    return centre_px < -margin_px || centre_px > size_px + margin_px;
  };
  return is_far(camera.ox_px(), camera.size_px.x()) || is_far(camera.oy_px(), camera.size_px.y());
}

}  // namespace

std::string impossible(const Rig& rig) {
  if (!parameters(rig).allFinite()) return "a parameter is not finite";
  if (std::string why = unphysical(rig); !why.empty()) return why;
  const auto far = std::find_if(rig.cameras.begin(), rig.cameras.end(), is_far_outside);
  return far == rig.cameras.end() ? "" : far->name + ": its centre is far outside the image";
}

}  // namespace vernier::sim::internal
