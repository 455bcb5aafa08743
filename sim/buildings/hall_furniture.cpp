// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/buildings/hall_furniture.h"

#include <algorithm>
#include <string>

#include "calib/statistics/random.h"
#include "sim/buildings/building_site.h"
#include "sim/buildings/furniture_parts.h"
#include "sim/buildings/wire_shapes.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

using Eigen::Vector3d;

constexpr std::uint32_t hall_template_item = 900;

FeatureSet column(double height) {
  Shapes s;
  s.box({-0.15, -0.15, 0}, {0.15, 0.15, height}, upright_faces);
  s.level_rectangle(-0.25, -0.25, 0.25, 0.25, 0.03);
  return s.features();
}

// An I-beam across the hall, below its roof.
FeatureSet roof_beam(double width) {
  Shapes s;
  s.box({-0.1, 0, -0.45}, {0.1, width, -0.43}, bottom_face | top_face);
  s.box({-0.1, 0, -0.02}, {0.1, width, 0}, bottom_face);
  s.surfaces_of_box({0, 0, -0.43}, {0, width, -0.02}, left_face);
  for (const double z : {-0.43, -0.02}) s.line({0, 0, z}, {0, width, z});
  return s.features();
}

// Uprights, braces and beams; open on all sides.
FeatureSet rack_bay() {
  Shapes s;
  constexpr double top = 4.2, post = 0.1;
  for (const double x : {0.0, bay_width_m - post}) {
    for (const double y : {0.02, bay_depth_m - post}) {
      s.leg({x, y, 0}, {x + post, y + post, top}, upright_faces);
      s.level_rectangle(x, y, x + post, y + post, top);
    }
    for (double z = 0.3; z + 0.9 < top; z += 0.9) {
      s.line({x + post / 2, 0.12, z}, {x + post / 2, bay_depth_m - post, z + 0.9});
    }
  }
  for (const double z : {bay_levels_m[1], bay_levels_m[2]}) {
    for (const double y : {0.02, bay_depth_m - 0.06}) {
      s.box({post, y, z - 0.12}, {bay_width_m - post, y + 0.05, z});
    }
  }
  return s.features();
}

// A pallet with a drawn stack of cartons.
FeatureSet pallet_load(RandomStream& draws) {
  Shapes s;
  constexpr double width = 1.2, depth = 0.8, deck = 0.144;
  s.box({0, 0.06, deck - 0.02}, {width, 0.06 + depth, deck}, top_face | bottom_face | front_face);
  for (const double x : {0.0, 0.53, 1.06}) {
    s.box({x, 0.06, 0}, {x + 0.14, 0.06 + depth, deck - 0.02}, upright_faces);
  }
  const int layers = 1 + static_cast<int>(draws.below(3));
  const double layer = draws.uniform(0.22, 0.36);
  for (int k = 0; k < layers; ++k) {
    const double low = deck + layer * k;
    const double shrink = k == 0 ? 0.01 : draws.uniform(0.01, 0.05);
    s.box({shrink, 0.06 + shrink, low},
          {width - shrink, 0.06 + depth - shrink, low + layer - 0.002}, standing_faces);
    const int columns = 2 + static_cast<int>(draws.below(2));
    for (int c = 1; c < columns; ++c) {
      const double x = shrink + (width - 2 * shrink) * c / columns;
      for (const double y : {0.06 + shrink, 0.06 + depth - shrink}) {
        s.line({x, y, low}, {x, y, low + layer - 0.002});
      }
    }
  }
  return s.features();
}

// A body, a bed in front of it, a panel with a screen, a chimney or a tank on top.
FeatureSet machine(RandomStream& draws) {
  Shapes s;
  const double width = draws.uniform(1.6, 2.8), depth = draws.uniform(0.9, 1.5);
  const double height = draws.uniform(1.4, 2.2), bed = draws.uniform(0.7, 1.0);
  s.box({0, 0.05, 0}, {width, 0.05 + 0.6 * depth, height}, standing_faces);
  s.box({0.1, 0.05 + 0.6 * depth, 0}, {width - 0.1, 0.05 + depth, bed}, standing_faces);
  const double panel = draws.uniform(0.1, 0.6) * width, front = 0.05 + 0.6 * depth + 0.003;
  s.upright_rectangle(panel, bed + 0.15, panel + 0.35 * width, height - 0.1, front);
  s.upright_rectangle(panel + 0.05, bed + 0.25, panel + 0.2 * width, height - 0.2, front + 0.002);
  const double x = draws.uniform(0.1, 0.6) * width, size = draws.uniform(0.2, 0.5);
  s.box({x, 0.1, height},
        {x + size, 0.1 + std::min(size, 0.5 * depth), height + draws.uniform(0.3, 0.8)},
        standing_faces);
  const int slots = 3 + static_cast<int>(draws.below(4));
  for (int k = 0; k < slots; ++k) {
    const double at = 0.2 + (width - 0.4) * k / slots;
    s.line({at, 0.05 + depth + 0.002, 0.15}, {at, 0.05 + depth + 0.002, bed - 0.15});
  }
  return s.features();
}

FeatureSet gate() {
  Shapes s;
  constexpr double width = 3.5, height = 3.8;
  s.upright_rectangle(0, 0, width, height, 0.01);
  s.upright_rectangle(-0.12, 0, width + 0.12, height + 0.12, 0.02);
  for (int k = 1; k < 7; ++k) {
    s.line({0, 0.012, height * k / 7}, {width, 0.012, height * k / 7});
  }
  for (int k = 0; k < 4; ++k) {
    const double x = 0.35 + 0.8 * k;
    s.upright_rectangle(x, 1.75, x + 0.5, 2.05, 0.014);
  }
  for (const double x : {-0.2, width + 0.2}) {
    s.box({x - 0.06, 0.02, 0}, {x + 0.06, 0.3, 1.0}, standing_faces);
  }
  return s.features();
}

FeatureSet high_window() {
  Shapes s;
  s.upright_rectangle(0, 0, 3, 1.1, 0.01);
  for (const double x : {1.0, 2.0}) s.line({x, 0.01, 0}, {x, 0.01, 1.1});
  s.line({0, 0.01, 0.55}, {3, 0.01, 0.55});
  return s.features();
}

FeatureSet workbench() {
  Shapes s;
  s.box({0, 0.02, 0.82}, {2.0, 0.75, 0.88});
  for (const double x : {0.06, 1.86})
    s.leg({x, 0.08, 0}, {x + 0.08, 0.7, 0.82}, left_face | right_face);
  s.upright_rectangle(0, 1.05, 2.0, 1.75, 0.03);
  for (int k = 1; k < 8; ++k)
    s.line({0.25 * k, 0.032, 1.15}, {0.25 * k, 0.032, 1.3 + 0.05 * (k % 4)});
  s.box({0.15, 0.1, 0.45}, {0.75, 0.68, 0.82}, all_faces - top_face);
  drawers(0.17, 0.73, 0.685, {0.46, 0.58, 0.7, 0.81}, s);
  return s.features();
}

FeatureSet electrical_cabinet() {
  Shapes s;
  s.box({0, 0.02, 0.1}, {0.8, 0.42, 2.0}, all_faces - back_face);
  leaves(0.8, 0.13, 1.97, 0.42, s);
  s.upright_rectangle(0.3, 1.7, 0.5, 1.85, 0.43);
  for (const double x : {0.2, 0.35}) s.line({x, 0.1, 2.0}, {x, 0.1, 2.9});
  return s.features();
}

FeatureSet strip_light() {
  Shapes s;
  s.box({-0.75, -0.08, -0.78}, {0.75, 0.08, -0.7});
  for (const double x : {-0.5, 0.5}) s.line({x, 0, -0.7}, {x, 0, 0});
  return s.features();
}

FeatureSet trolley() {
  Shapes s;
  s.box({-0.45, -0.3, 0.18}, {0.45, 0.3, 0.24});
  for (const double y : {-0.25, 0.25}) s.line({-0.45, y, 0.24}, {-0.45, y, 0.95});
  s.line({-0.45, -0.25, 0.95}, {-0.45, 0.25, 0.95});
  s.line({-0.45, -0.25, 0.6}, {-0.45, 0.25, 0.6});
  return s.features();
}

}  // namespace

std::vector<WorldTemplate> hall_templates(std::uint64_t seed, double width_m, double height_m) {
  std::vector<WorldTemplate> templates{{"column", column(height_m)},
                                       {"roof_beam", roof_beam(width_m)},
                                       {"rack_bay", rack_bay()},
                                       {"gate", gate()},
                                       {"high_window", high_window()},
                                       {"workbench", workbench()},
                                       {"electrical_cabinet", electrical_cabinet()},
                                       {"strip_light", strip_light()},
                                       {"trolley", trolley()}};
  for (std::uint32_t i = 0; i < 4; ++i) {
    RandomStream draws(
        {.seed = seed, .trial = 0, .feature = hall_template_item + i, .source = building_draws});
    templates.push_back({"pallet_load_" + std::to_string(i + 1), pallet_load(draws)});
  }
  for (std::uint32_t i = 0; i < 3; ++i) {
    RandomStream draws({.seed = seed,
                        .trial = 0,
                        .feature = hall_template_item + 10 + i,
                        .source = building_draws});
    templates.push_back({"machine_" + std::to_string(i + 1), machine(draws)});
  }
  return templates;
}

}  // namespace vernier::sim::internal
