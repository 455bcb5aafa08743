// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/buildings/home_furniture.h"

#include <array>

#include "sim/buildings/furniture_parts.h"
#include "sim/buildings/wire_shapes.h"
#include "sim/world.h"

namespace vernier::sim::internal {
namespace {

void four_legs(double x0, double y0, double x1, double y1, double z, Shapes& s) {
  for (const double x : {x0, x1}) {
    for (const double y : {y0, y1}) s.line({x, y, 0}, {x, y, z});
  }
}

FeatureSet bed(double width) {
  Shapes s;
  s.box({0, 0.02, 0}, {width, 0.08, 0.95}, leaning_faces);
  s.box({0.02, 0.08, 0.12}, {width - 0.02, 2.08, 0.34});
  s.box({0.04, 0.1, 0.34}, {width - 0.04, 2.05, 0.5}, standing_faces);
  const int pillows = width > 1.3 ? 2 : 1;
  const double share = (width - 0.2) / pillows;
  for (int k = 0; k < pillows; ++k) {
    const double x = 0.1 + share * k;
    s.box({x + 0.04, 0.14, 0.5}, {x + share - 0.04, 0.54, 0.6}, standing_faces);
  }
  s.line({0.04, 0.75, 0.501}, {width - 0.04, 0.75, 0.501});
  return s.features();
}

FeatureSet night_table() {
  Shapes s;
  s.box({0, 0.02, 0.05}, {0.45, 0.42, 0.5});
  drawers(0.02, 0.43, 0.425, {0.08, 0.28, 0.48}, s);
  return s.features();
}

FeatureSet wardrobe() {
  Shapes s;
  s.box({0, 0.02, 0}, {1.0, 0.6, 2.1}, leaning_faces);
  leaves(1.0, 0.08, 2.07, 0.6, s);
  return s.features();
}

FeatureSet dresser() {
  Shapes s;
  s.box({0, 0.02, 0}, {1.0, 0.46, 0.86}, leaning_faces);
  drawers(0.02, 0.49, 0.465, {0.06, 0.32, 0.58, 0.84}, s);
  drawers(0.51, 0.98, 0.465, {0.06, 0.32, 0.58, 0.84}, s);
  return s.features();
}

FeatureSet sofa(int seats) {
  Shapes s;
  const double arm = 0.18, seat = 0.62, width = 2 * arm + seats * seat;
  s.box({arm, 0.04, 0.3}, {width - arm, 0.26, 0.82});
  s.box({0, 0.04, 0.08}, {arm, 0.88, 0.6});
  s.box({width - arm, 0.04, 0.08}, {width, 0.88, 0.6});
  s.box({arm, 0.26, 0.08}, {width - arm, 0.88, 0.42});
  for (int k = 1; k < seats; ++k) {
    const double x = arm + seat * k;
    s.line({x, 0.26, 0.42}, {x, 0.88, 0.42});
    s.line({x, 0.26, 0.42}, {x, 0.26, 0.82});
    s.line({x, 0.88, 0.42}, {x, 0.88, 0.2});
  }
  return s.features();
}

FeatureSet coffee_table() {
  Shapes s;
  s.box({-0.55, -0.3, 0.38}, {0.55, 0.3, 0.42});
  four_legs(-0.5, -0.25, 0.5, 0.25, 0.38, s);
  s.level_rectangle(-0.5, -0.25, 0.5, 0.25, 0.15);
  return s.features();
}

FeatureSet dining_table() {
  Shapes s;
  s.box({-0.7, -0.42, 0.71}, {0.7, 0.42, 0.75});
  four_legs(-0.64, -0.36, 0.64, 0.36, 0.71, s);
  return s.features();
}

FeatureSet dining_chair() {
  Shapes s;
  s.box({-0.21, -0.2, 0.43}, {0.21, 0.2, 0.46});
  four_legs(-0.19, -0.18, 0.19, 0.18, 0.43, s);
  for (const double x : {-0.19, 0.19}) s.line({x, 0.19, 0.46}, {x, 0.19, 0.92});
  for (const double z : {0.6, 0.7, 0.8, 0.92}) s.line({-0.19, 0.19, z}, {0.19, 0.19, z});
  return s.features();
}

FeatureSet television() {
  Shapes s;
  s.box({0, 0.02, 0}, {1.6, 0.42, 0.45}, leaning_faces);
  for (const double x : {0.54, 1.07}) s.line({x, 0.425, 0.03}, {x, 0.425, 0.42});
  s.box({0.2, 0.15, 0.52}, {1.4, 0.19, 1.2});
  s.upright_rectangle(0.22, 0.54, 1.38, 1.18, 0.191);
  for (const double x : {0.5, 1.1}) s.line({x, 0.17, 0.45}, {x, 0.17, 0.52});
  return s.features();
}

// A floor unit of a kitchen: body, toe space and worktop.
void kitchen_body(Shapes& s) {
  s.box({0, 0.02, 0.1}, {0.6, 0.58, 0.86}, leaning_faces);
  s.box({0, 0.02, 0.86}, {0.6, 0.62, worktop_m}, left_face | right_face | front_face | top_face);
  s.line({0, 0.54, 0}, {0.6, 0.54, 0});
  s.surfaces_of_box({0, 0.54, 0}, {0.6, 0.54, 0.1}, back_face);
}

FeatureSet kitchen_unit() {
  Shapes s;
  kitchen_body(s);
  s.upright_rectangle(0.01, 0.12, 0.59, 0.85, 0.585);
  s.line({0.5, 0.6, 0.6}, {0.5, 0.6, 0.8});
  return s.features();
}

FeatureSet kitchen_drawers() {
  Shapes s;
  kitchen_body(s);
  drawers(0.01, 0.59, 0.585, {0.12, 0.42, 0.66, 0.85}, s);
  return s.features();
}

FeatureSet kitchen_sink() {
  Shapes s;
  kitchen_body(s);
  s.upright_rectangle(0.01, 0.12, 0.59, 0.85, 0.585);
  s.level_rectangle(0.08, 0.12, 0.52, 0.5, worktop_m + 0.001);
  s.line({0.3, 0.1, worktop_m}, {0.3, 0.1, 1.2});
  s.line({0.3, 0.1, 1.2}, {0.3, 0.3, 1.2});
  return s.features();
}

FeatureSet kitchen_stove() {
  Shapes s;
  kitchen_body(s);
  s.upright_rectangle(0.02, 0.2, 0.58, 0.68, 0.585);
  s.upright_rectangle(0.08, 0.28, 0.52, 0.6, 0.586);
  s.line({0.06, 0.61, 0.7}, {0.54, 0.61, 0.7});
  for (const double x : {0.07, 0.33}) {
    for (const double y : {0.08, 0.34}) {
      s.level_rectangle(x, y, x + 0.2, y + 0.2, worktop_m + 0.001);
    }
  }
  return s.features();
}

FeatureSet wall_cabinet() {
  Shapes s;
  s.box({0, 0.0, 1.42}, {0.6, 0.34, 2.12}, all_faces - back_face);
  s.upright_rectangle(0.01, 1.43, 0.59, 2.11, 0.345);
  s.line({0.53, 0.36, 1.46}, {0.53, 0.36, 1.6});
  return s.features();
}

FeatureSet fridge() {
  Shapes s;
  s.box({0, 0.03, 0.02}, {0.6, 0.66, 1.78}, leaning_faces);
  s.line({0, 0.665, 0.66}, {0.6, 0.665, 0.66});
  for (const double z : {0.72, 0.4}) s.line({0.06, 0.69, z}, {0.06, 0.69, z + 0.22});
  return s.features();
}

FeatureSet bathtub() {
  Shapes s;
  s.box({0, 0.01, 0}, {1.7, 0.75, 0.55}, left_face | right_face | front_face);
  s.level_rectangle(0.08, 0.09, 1.62, 0.67, 0.55);
  s.level_rectangle(0.2, 0.16, 1.5, 0.6, 0.12);
  s.surfaces_of_box({0.08, 0.09, 0.12}, {1.62, 0.67, 0.12}, bottom_face);
  s.line({0.85, 0.02, 0.7}, {0.85, 0.14, 0.7});
  return s.features();
}

FeatureSet washbasin() {
  Shapes s;
  s.box({0, 0.01, 0.68}, {0.6, 0.46, 0.86}, all_faces - back_face - top_face);
  s.level_rectangle(0.06, 0.1, 0.54, 0.42, 0.86);
  s.line({0.3, 0.05, 0.86}, {0.3, 0.05, 0.98});
  s.line({0.3, 0.05, 0.98}, {0.3, 0.17, 0.98});
  s.upright_rectangle(0.02, 1.15, 0.58, 1.9, 0.01);
  s.upright_rectangle(0.05, 1.18, 0.55, 1.87, 0.012);
  return s.features();
}

FeatureSet toilet() {
  Shapes s;
  s.box({0, 0.01, 0.4}, {0.38, 0.18, 0.78}, leaning_faces);
  s.box({0.02, 0.18, 0}, {0.36, 0.66, 0.4}, standing_faces);
  s.line({0.02, 0.22, 0.401}, {0.36, 0.22, 0.401});
  s.level_rectangle(0.13, 0.06, 0.25, 0.12, 0.781);
  return s.features();
}

FeatureSet towel_rail() {
  Shapes s;
  for (const double x : {0.0, 0.5}) s.line({x, 0.06, 0.7}, {x, 0.06, 1.7});
  for (int k = 0; k < 9; ++k) s.line({0, 0.06, 0.75 + 0.11 * k}, {0.5, 0.06, 0.75 + 0.11 * k});
  return s.features();
}

FeatureSet floor_lamp() {
  Shapes s;
  s.level_rectangle(-0.13, -0.13, 0.13, 0.13, 0.02);
  s.line({0, 0, 0.02}, {0, 0, 1.4});
  s.level_rectangle(-0.2, -0.2, 0.2, 0.2, 1.4);
  s.level_rectangle(-0.12, -0.12, 0.12, 0.12, 1.7);
  for (const double x : {-1, 1}) {
    for (const double y : {-1, 1}) s.line({0.2 * x, 0.2 * y, 1.4}, {0.12 * x, 0.12 * y, 1.7});
  }
  s.surfaces_of_box({-0.16, -0.16, 1.42}, {0.16, 0.16, 1.68}, upright_faces);
  return s.features();
}

FeatureSet potted_plant() {
  Shapes s;
  s.box({-0.16, -0.16, 0}, {0.16, 0.16, 0.34}, standing_faces);
  const std::array<std::array<double, 3>, 6> tips{{{0.3, 0.05, 1.1},
                                                   {-0.24, 0.18, 1.25},
                                                   {0.06, -0.3, 0.95},
                                                   {-0.12, -0.2, 1.3},
                                                   {0.18, 0.24, 0.85},
                                                   {-0.3, -0.04, 0.9}}};
  for (const auto& tip : tips) {
    s.line({0.2 * tip[0], 0.2 * tip[1], 0.34}, {0.6 * tip[0], 0.6 * tip[1], 0.9 * tip[2]});
    s.line({0.6 * tip[0], 0.6 * tip[1], 0.9 * tip[2]}, {tip[0], tip[1], 0.85 * tip[2]});
  }
  return s.features();
}

FeatureSet rug() {
  Shapes s;
  s.level_rectangle(-1.0, -0.7, 1.0, 0.7, 0.008);
  s.level_rectangle(-0.9, -0.6, 0.9, 0.6, 0.008);
  return s.features();
}

FeatureSet pendant_lamp() {
  Shapes s;
  s.line({0, 0, 0}, {0, 0, -0.3});
  s.level_rectangle(-0.2, -0.2, 0.2, 0.2, -0.46);
  s.level_rectangle(-0.08, -0.08, 0.08, 0.08, -0.3);
  for (const double x : {-1, 1}) {
    for (const double y : {-1, 1}) s.line({0.2 * x, 0.2 * y, -0.46}, {0.08 * x, 0.08 * y, -0.3});
  }
  return s.features();
}

}  // namespace

std::vector<WorldTemplate> home_templates() {
  return {{"double_bed", bed(1.6)},
          {"single_bed", bed(0.9)},
          {"night_table", night_table()},
          {"wardrobe", wardrobe()},
          {"dresser", dresser()},
          {"sofa", sofa(3)},
          {"armchair", sofa(1)},
          {"coffee_table", coffee_table()},
          {"dining_table", dining_table()},
          {"dining_chair", dining_chair()},
          {"television", television()},
          {"kitchen_unit", kitchen_unit()},
          {"kitchen_drawers", kitchen_drawers()},
          {"kitchen_sink", kitchen_sink()},
          {"kitchen_stove", kitchen_stove()},
          {"wall_cabinet", wall_cabinet()},
          {"fridge", fridge()},
          {"bathtub", bathtub()},
          {"washbasin", washbasin()},
          {"toilet", toilet()},
          {"towel_rail", towel_rail()},
          {"floor_lamp", floor_lamp()},
          {"potted_plant", potted_plant()},
          {"rug", rug()},
          {"pendant_lamp", pendant_lamp()}};
}

}  // namespace vernier::sim::internal
