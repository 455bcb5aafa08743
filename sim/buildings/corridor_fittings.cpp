// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/buildings/corridor_fittings.h"

#include "sim/buildings/office_furniture.h"
#include "sim/buildings/wire_shapes.h"
#include "sim/world.h"

namespace vernier::sim::internal {
namespace {

// Frame, leaf set back in it, handle and its plate.
void shut_leaf(double from, double to, bool handle_at_end, Shapes& s) {
  s.upright_rectangle(from + 0.01, 0.01, to - 0.01, door_height_m - 0.01, 0.004);
  const double plate = handle_at_end ? to - 0.09 : from + 0.09;
  const double grip = handle_at_end ? plate - 0.11 : plate + 0.11;
  s.upright_rectangle(plate - 0.02, 0.95, plate + 0.02, 1.15, 0.008);
  s.line({plate, 0.05, 1.06}, {grip, 0.05, 1.06});
}

FeatureSet closed_door() {
  Shapes s;
  const double half = door_width_m / 2, top = door_height_m;
  for (const double out : {0.0, casing_m}) {
    s.line({-half - out, 0.012, 0}, {-half - out, 0.012, top + out});
    s.line({-half - out, 0.012, top + out}, {half + out, 0.012, top + out});
    s.line({half + out, 0.012, top + out}, {half + out, 0.012, 0});
  }
  shut_leaf(-half, half, true, s);
  return s.features();
}

FeatureSet double_door() {
  Shapes s;
  const double half = 0.9, top = door_height_m;
  for (const double out : {0.0, casing_m}) {
    s.line({-half - out, 0.012, 0}, {-half - out, 0.012, top + out});
    s.line({-half - out, 0.012, top + out}, {half + out, 0.012, top + out});
    s.line({half + out, 0.012, top + out}, {half + out, 0.012, 0});
  }
  shut_leaf(-half, 0, true, s);
  shut_leaf(0, half, false, s);
  for (const double x : {-0.6, 0.3}) s.upright_rectangle(x, 1.25, x + 0.3, 1.85, 0.006);
  return s.features();
}

FeatureSet bench() {
  Shapes s;
  s.box({0, 0.1, 0.42}, {1.5, 0.5, 0.46});
  s.upright_rectangle(0, 0.55, 1.5, 0.85, 0.1);
  for (const double x : {0.15, 1.35}) {
    s.line({x, 0.14, 0}, {x, 0.14, 0.55});
    s.line({x, 0.46, 0}, {x, 0.46, 0.42});
  }
  return s.features();
}

FeatureSet extinguisher() {
  Shapes s;
  s.box({0, 0.03, 0.6}, {0.16, 0.19, 1.1});
  s.line({0.08, 0.11, 1.1}, {0.08, 0.11, 1.18});
  s.upright_rectangle(-0.02, 1.6, 0.18, 1.8, 0.01);
  return s.features();
}

FeatureSet handrail() {
  Shapes s;
  s.box({0, 0.05, 0.85}, {1.8, 0.09, 0.95});
  for (const double x : {0.2, 1.6}) s.line({x, 0.05, 0.88}, {x, 0.0, 0.88});
  return s.features();
}

FeatureSet exit_sign() {
  Shapes s;
  s.box({-0.2, -0.02, -0.35}, {0.2, 0.02, -0.15});
  for (const double x : {-0.15, 0.15}) s.line({x, 0, -0.15}, {x, 0, 0});
  return s.features();
}

FeatureSet tea_trolley() {
  Shapes s;
  for (const double z : {0.2, 0.55, 0.9}) s.box({0, 0.05, z}, {0.8, 0.5, z + 0.02});
  for (const double x : {0.0, 0.8}) {
    for (const double y : {0.05, 0.5}) s.line({x, y, 0.05}, {x, y, 0.95});
  }
  return s.features();
}

}  // namespace

std::vector<WorldTemplate> corridor_templates() {
  return {
      {"closed_door", closed_door()},   {"double_door", double_door()}, {"bench", bench()},
      {"extinguisher", extinguisher()}, {"handrail", handrail()},       {"exit_sign", exit_sign()},
      {"tea_trolley", tea_trolley()}};
}

}  // namespace vernier::sim::internal
