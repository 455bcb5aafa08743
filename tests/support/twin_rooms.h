// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>

#include "sim/world.h"

namespace vernier::test {

using namespace vernier::sim;

/// Two closed rooms of 4 x 5 m with the same four cupboards, 10 m apart; the second may get one
/// more.
inline World twin_rooms(bool tell_apart) {
  WorldDescription d;
  const auto box = [](double x, double y, double z, double sx, double sy, double sz) {
    FeatureSet f;
    const auto corner = [&](int i) {
      return Eigen::Vector3d(x + (i & 1) * sx, y + (i >> 1 & 1) * sy, z + (i >> 2) * sz);
    };
    for (int i = 0; i < 8; ++i) {
      for (const int axis : {1, 2, 4}) {
        if (!(i & axis)) f.segments_m.emplace_back(corner(i), corner(i | axis));
      }
    }
    for (const auto& face :
         {std::array{0, 1, 3, 2}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
          std::array{2, 3, 7, 6}, std::array{0, 2, 6, 4}, std::array{1, 3, 7, 5}}) {
      f.surfaces_m.push_back({corner(face[0]), corner(face[1]), corner(face[2]), corner(face[3])});
    }
    return f;
  };
  d.templates.push_back({"room", box(0, 0, 0, 4, 5, 2.5)});
  d.templates.push_back({"cupboard", box(0, 0, 0, 0.8, 0.4, 1.8)});
  for (const double x : {0.0, 10.0}) {
    d.instances.push_back({"room", {x, 0, 0}, 0});
    d.instances.push_back({"cupboard", {x + 0.3, 4.5, 0}, 0});
    d.instances.push_back({"cupboard", {x + 2.1, 4.4, 0}, 0});
    d.instances.push_back({"cupboard", {x + 3.5, 3.1, 0}, 0});
  }
  if (tell_apart) d.instances.push_back({"cupboard", {11.4, 3.7, 0}, 0.4});
  d.route.push_back({{{2, 0.5}, {2, 2}}});
  return build_world(d);
}

}  // namespace vernier::test
