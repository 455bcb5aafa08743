// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/fuzz_target.h"
#include "sim/buildings/office.h"
#include "sim/world.h"
#include "sim/world_file.h"

namespace vernier::fuzz {
namespace {

using namespace vernier::sim;

void run_world_toml(std::string_view bytes) {
  const auto world = accepted([&] { return parse_world(std::string(bytes), "world.toml"); });
  if (!world) return;
  accepted([&] { return repeated_share(build_world(*world)); });
  const auto text = accepted([&] { return format_world(*world); });
  if (!text) return;
  const WorldDescription again = parse_world(*text, "written");
  require(again.templates.size() == world->templates.size() &&
              again.instances.size() == world->instances.size() &&
              again.loose.segments_m.size() == world->loose.segments_m.size() &&
              again.loose.surfaces_m.size() == world->loose.surfaces_m.size() &&
              again.loose.corners_m.size() == world->loose.corners_m.size() &&
              again.route.size() == world->route.size(),
          "the features are kept");
  require(format_world(again) == *text, "reading and writing gives the same text");
}

std::vector<std::string> world_toml_seeds() {
  WorldDescription world = sim::internal::make_office(1, {.size_m = {9, 10, 2.5}});
  std::vector<std::string> seeds;
  world.templates.resize(2);
  std::erase_if(world.instances, [&](const WorldInstance& instance) {
    return instance.template_name != world.templates[0].name;
  });
  if (world.instances.size() > 2) world.instances.resize(2);
  world.templates.resize(1);
  for (FeatureSet* features : {&world.templates[0].features, &world.loose}) {
    if (features->segments_m.size() > 4) features->segments_m.resize(4);
    if (features->surfaces_m.size() > 2) features->surfaces_m.resize(2);
    if (features->corners_m.size() > 2) features->corners_m.resize(2);
  }
  seeds.push_back(format_world(world));
  seeds.push_back(
      "format = \"vernier/world\"\nversion = 1\n[[segment]]\nsegment = [0, 0, 0, 1, 0, 2]\n"
      "[[surface]]\npolygon = [[0, 0, 0], [1, 0, 0], [1, 0, 2]]\n[[corner]]\nat_m = [1, 2, 3]\n"
      "[[route]]\npoints_m = [[1, 1], [9, 1]]\n");
  return seeds;
}

const Registered registered_world_toml{
    {"world_toml", 4000, "world", run_world_toml, world_toml_seeds}};

}  // namespace
}  // namespace vernier::fuzz
