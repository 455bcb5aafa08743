// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/buildings/office_furniture.h"

#include <array>
#include <vector>

#include "sim/buildings/furniture_parts.h"
#include "sim/buildings/wire_shapes.h"
#include "sim/world.h"

namespace vernier::sim::internal {
namespace {

FeatureSet door_frame() {
  Shapes s;
  const double half = door_width_m / 2, top = door_height_m, out = half + casing_m;
  const double near = 0.01, far = -wall_thickness_m - 0.01;  // the casing protrudes from both faces
  for (const double y : {near, far}) {
    for (const double x : {half, out}) {
      const double z = top + (x - half);
      s.line({-x, y, 0}, {-x, y, z});
      s.line({-x, y, z}, {x, y, z});
      s.line({x, y, z}, {x, y, 0});
    }
    s.line({-half, y, 0}, {half, y, 0});
  }
  for (const double x : {-half, half}) {
    s.line({x, near, 0}, {x, far, 0});
    s.line({x, near, top}, {x, far, top});
  }
  const double stop = -0.06, inner = half - 0.015, under = top - 0.015;
  s.line({-inner, stop, 0}, {-inner, stop, under});
  s.line({-inner, stop, under}, {inner, stop, under});
  s.line({inner, stop, under}, {inner, stop, 0});
  return s.features();
}

// Open by half a turn, so that it lies against the wall beside the opening; the handle is on the
// edge away from the hinge.
FeatureSet door_leaf(bool hinge_at_low_x) {
  Shapes s;
  s.box({0, 0.02, 0.01}, {0.88, 0.06, 2.03}, standing_faces);
  s.upright_rectangle(0.15, 1.15, 0.73, 1.85, 0.062);
  s.upright_rectangle(0.15, 0.2, 0.73, 0.95, 0.062);
  const double plate = hinge_at_low_x ? 0.81 : 0.07, grip = hinge_at_low_x ? 0.72 : 0.16;
  s.upright_rectangle(plate - 0.02, 0.96, plate + 0.02, 1.14, 0.065);
  s.line({plate, 0.09, 1.05}, {grip, 0.09, 1.05});
  return s.features();
}

FeatureSet window() {
  Shapes s;
  s.upright_rectangle(0, 0.95, 1.5, 2.1, 0);
  for (const double x : {0.08, 0.78}) {
    s.upright_rectangle(x, 1.03, x + 0.64, 2.02, 0.02);
    s.upright_rectangle(x + 0.06, 1.09, x + 0.58, 1.96, 0.01);
  }
  s.upright_rectangle(0.735, 1.42, 0.765, 1.56, 0.02);
  s.box({-0.05, 0, 0.9}, {1.55, 0.16, 0.93}, all_faces - back_face);
  return s.features();
}

FeatureSet radiator() {
  Shapes s;
  s.box({0, 0.04, 0.14}, {1.2, 0.14, 0.74}, all_faces);
  for (int k = 1; k < 10; ++k) s.line({0.12 * k, 0.14, 0.17}, {0.12 * k, 0.14, 0.71});
  s.line({1.2, 0.09, 0.2}, {1.26, 0.09, 0.2});
  s.line({1.26, 0.09, 0.2}, {1.26, 0.09, 0});
  return s.features();
}

FeatureSet ceiling_light() {
  Shapes s;
  s.box({-0.6, -0.15, -0.07}, {0.6, 0.15, 0}, hanging_faces);
  for (const double x : {-0.2, 0.2}) s.line({x, -0.15, -0.07}, {x, 0.15, -0.07});
  return s.features();
}

FeatureSet ceiling_vent() {
  Shapes s;
  s.level_rectangle(-0.3, -0.3, 0.3, 0.3, -0.01);
  s.level_rectangle(-0.25, -0.25, 0.25, 0.25, -0.01);
  for (int k = -2; k <= 2; ++k) s.line({-0.25, 0.08 * k, -0.02}, {0.25, 0.08 * k, -0.02});
  return s.features();
}

FeatureSet desk() {
  Shapes s;
  s.box({0, 0.02, 0.71}, {1.6, 0.8, board_top_m});
  s.leg({0.04, 0.06, 0}, {0.07, 0.74, 0.71}, left_face | right_face);
  s.leg({1.53, 0.06, 0}, {1.56, 0.74, 0.71}, left_face | right_face);
  s.line({0.07, 0.12, 0.3}, {1.53, 0.12, 0.3});
  s.surfaces_of_box({0.07, 0.12, 0.3}, {1.53, 0.12, 0.71}, back_face);
  return s.features();
}

FeatureSet table() {
  Shapes s;
  s.box({0, 0.02, 0.7}, {1.2, 0.72, board_top_m});
  for (const double x : {0.05, 1.15}) {
    for (const double y : {0.07, 0.67}) s.line({x, y, 0}, {x, y, 0.7});
  }
  return s.features();
}

FeatureSet pedestal() {
  Shapes s;
  s.box({0, 0.2, 0.04}, {0.42, 0.76, 0.62});
  drawers(0.01, 0.41, 0.765, {0.05, 0.32, 0.47, 0.61}, s);
  return s.features();
}

FeatureSet filing_cabinet() {
  Shapes s;
  s.box({0, 0.02, 0}, {0.46, 0.62, 1.32}, leaning_faces);
  drawers(0.02, 0.44, 0.625, {0.04, 0.36, 0.68, 1.0, 1.3}, s);
  return s.features();
}

FeatureSet monitor() {
  Shapes s;
  s.box({-0.27, -0.02, 0.12}, {0.27, 0.02, 0.44});
  s.upright_rectangle(-0.255, 0.14, 0.255, 0.425, 0.021);
  for (const double x : {-0.03, 0.03}) s.line({x, -0.03, 0.01}, {x, -0.03, 0.12});
  s.level_rectangle(-0.12, -0.1, 0.12, 0.1, 0.01);
  return s.features();
}

FeatureSet keyboard() {
  Shapes s;
  s.box({-0.22, -0.07, 0}, {0.22, 0.07, 0.02}, top_face);
  s.line({0.1, -0.07, 0.02}, {0.1, 0.07, 0.02});
  return s.features();
}

FeatureSet office_chair() {
  Shapes s;
  s.box({-0.23, -0.22, 0.43}, {0.23, 0.22, 0.49});
  s.box({-0.2, 0.2, 0.56}, {0.2, 0.24, 0.95});
  s.line({0, 0, 0.08}, {0, 0, 0.43});
  s.line({0, 0.22, 0.49}, {0, 0.22, 0.56});
  const std::array<std::array<double, 2>, 5> feet{
      {{0.29, 0}, {0.09, 0.276}, {-0.235, 0.17}, {-0.235, -0.17}, {0.09, -0.276}}};
  for (const auto& foot : feet) s.line({0, 0, 0.08}, {foot[0], foot[1], 0.05});
  return s.features();
}

FeatureSet visitor_chair() {
  Shapes s;
  s.box({-0.22, -0.21, 0.43}, {0.22, 0.21, 0.46});
  s.upright_rectangle(-0.21, 0.6, 0.21, 0.84, 0.2);
  s.surfaces_of_box({-0.21, 0.2, 0.6}, {0.21, 0.2, 0.84}, back_face);
  for (const double x : {-0.21, 0.21}) {
    s.line({x, -0.2, 0}, {x, -0.2, 0.43});
    s.line({x, 0.2, 0}, {x, 0.2, 0.6});
    s.line({x, -0.2, 0.1}, {x, 0.2, 0.1});
  }
  return s.features();
}

FeatureSet bookshelf() {
  Shapes s;
  const double width = shelf_clear_m + 2 * shelf_side_m, depth = 0.32, height = 2.0;
  s.box({0, 0.02, 0}, {width, depth, height}, left_face | right_face | back_face | top_face);
  for (const double x : {shelf_side_m, width - shelf_side_m}) {
    s.line({x, depth, 0}, {x, depth, height - 0.03});
  }
  for (const double z : shelf_boards_m) {
    for (const double edge : {z - 0.025, z}) {
      s.line({shelf_side_m, depth, edge}, {width - shelf_side_m, depth, edge});
    }
    s.surfaces_of_box({shelf_side_m, 0.02, z - 0.025}, {width - shelf_side_m, depth, z},
                      top_face | bottom_face);
  }
  s.line({shelf_side_m, depth, height - 0.03}, {width - shelf_side_m, depth, height - 0.03});
  return s.features();
}

FeatureSet cupboard() {
  Shapes s;
  s.box({0, 0.02, 0}, {1.0, 0.45, 1.8}, leaning_faces);
  leaves(1.0, 0.06, 1.78, 0.45, s);
  return s.features();
}

FeatureSet sideboard() {
  Shapes s;
  s.box({0, 0.02, 0}, {1.2, 0.45, 0.78}, leaning_faces);
  leaves(1.2, 0.06, 0.75, 0.45, s);
  return s.features();
}

FeatureSet locker() {
  Shapes s;
  s.box({0, 0.02, 0}, {0.4, 0.42, 1.8}, leaning_faces);
  for (const double z : {0.1, 0.95}) {
    s.upright_rectangle(0.02, z, 0.38, z + 0.82, 0.425);
    for (int k = 0; k < 2; ++k) {
      s.line({0.12, 0.43, z + 0.66 + 0.04 * k}, {0.28, 0.43, z + 0.66 + 0.04 * k});
    }
    s.line({0.34, 0.435, z + 0.36}, {0.34, 0.435, z + 0.46});
  }
  return s.features();
}

FeatureSet notice_board() {
  Shapes s;
  s.upright_rectangle(0, 1.15, 1.2, 2.0, 0.015);
  s.upright_rectangle(0.03, 1.18, 1.17, 1.97, 0.015);
  return s.features();
}

FeatureSet whiteboard() {
  Shapes s;
  s.upright_rectangle(0, 1.0, 1.5, 2.0, 0.02);
  s.upright_rectangle(0.02, 1.02, 1.48, 1.98, 0.02);
  s.level_rectangle(0.2, 0.02, 1.3, 0.08, 0.98);
  return s.features();
}

FeatureSet bin() {
  Shapes s;
  s.level_rectangle(-0.11, -0.11, 0.11, 0.11, 0);
  s.level_rectangle(-0.15, -0.15, 0.15, 0.15, 0.36);
  for (const double x : {-1, 1}) {
    for (const double y : {-1, 1}) s.line({0.11 * x, 0.11 * y, 0}, {0.15 * x, 0.15 * y, 0.36});
  }
  s.surfaces_of_box({-0.12, -0.12, 0}, {0.12, 0.12, 0.3}, upright_faces);
  return s.features();
}

FeatureSet socket() {
  Shapes s;
  s.upright_rectangle(0, 0.26, 0.16, 0.34, 0.01);
  s.line({0.08, 0.01, 0.26}, {0.08, 0.01, 0.34});
  return s.features();
}

FeatureSet light_switch() {
  Shapes s;
  s.upright_rectangle(0, 1.05, 0.08, 1.21, 0.01);
  s.upright_rectangle(0.015, 1.065, 0.065, 1.115, 0.015);
  s.upright_rectangle(0.015, 1.145, 0.065, 1.195, 0.015);
  return s.features();
}

FeatureSet door_sign() {
  Shapes s;
  s.upright_rectangle(0, 1.45, 0.2, 1.6, 0.01);
  s.line({0.02, 0.01, 1.55}, {0.18, 0.01, 1.55});
  s.line({0.02, 0.01, 1.5}, {0.14, 0.01, 1.5});
  return s.features();
}

}  // namespace

std::vector<WorldTemplate> office_templates() {
  return {{"door_frame", door_frame()},
          {"door_leaf_right", door_leaf(true)},
          {"door_leaf_left", door_leaf(false)},
          {"window", window()},
          {"radiator", radiator()},
          {"ceiling_light", ceiling_light()},
          {"ceiling_vent", ceiling_vent()},
          {"desk", desk()},
          {"table", table()},
          {"pedestal", pedestal()},
          {"filing_cabinet", filing_cabinet()},
          {"monitor", monitor()},
          {"keyboard", keyboard()},
          {"office_chair", office_chair()},
          {"visitor_chair", visitor_chair()},
          {"bookshelf", bookshelf()},
          {"cupboard", cupboard()},
          {"sideboard", sideboard()},
          {"locker", locker()},
          {"notice_board", notice_board()},
          {"whiteboard", whiteboard()},
          {"bin", bin()},
          {"socket", socket()},
          {"light_switch", light_switch()},
          {"door_sign", door_sign()}};
}

}  // namespace vernier::sim::internal
