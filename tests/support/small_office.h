// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/rig_estimate.h"
#include "datasets/shipped.h"
#include "sim/buildings/office.h"
#include "sim/noise_free_view.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::test {

using namespace vernier::sim;
using namespace vernier::sim::internal;

/// An office of a few rooms, made once: small enough for unit tests, of another seed than any
/// world that judges a method.
inline const World& small_office() {
  static const World world = [] {
    OfficeOptions options;
    options.size_m = {9, 10, 2.5};
    return build_world(make_office(31, options));
  }();
  return world;
}

inline const Visibility& small_office_visibility() {
  static const Visibility visibility(small_office());
  return visibility;
}

inline const RigEstimate& nominal_rig() {
  static const RigEstimate rig = datasets::nominal();
  return rig;
}

/// One look at the office by the nominal rig, corners included.
inline const NoiseFreeView& office_look() {
  static const NoiseFreeView seen = [] {
    NoiseFreeViewOptions options;
    options.with_corners = true;
    return look(small_office_visibility(), nominal_rig().rig, map_poses(small_office().route, 2)[2],
                options);
  }();
  return seen;
}

}  // namespace vernier::test
