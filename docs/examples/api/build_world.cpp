// Builds a world of doors and a pillar, writes and reads it, and asks what can be seen from where.
#include <cstdio>
#include <numbers>
#include <string>
#include <utility>

#include "sim/visibility.h"
#include "sim/world.h"
#include "sim/world_file.h"

int main(int, char** argv) {
  using namespace vernier::sim;
  WorldDescription corridor;
  corridor.name = "corridor";
  WorldTemplate door{"door", {}};
  door.features.segments_m = {
      {{0, 0, 0}, {0, 0, 2}}, {{0.9, 0, 0}, {0.9, 0, 2}}, {{0, 0, 2}, {0.9, 0, 2}}};
  door.features.corners_m = {{0, 0, 2}, {0.9, 0, 2}};
  corridor.templates = {door};
  for (int i = 0; i < 6; ++i) {
    corridor.instances.push_back({"door", {2.0 * i, 0, 0}, 0});
    corridor.instances.push_back({"door", {2.0 * i, 2.5, 0}, 0});
  }
  corridor.loose.surfaces_m = {{{5, 1, 0}, {5, 1.6, 0}, {5, 1.6, 2.5}, {5, 1, 2.5}}};  // a pillar
  corridor.route = {{{{0.5, 1.25}, {10, 1.25}}}};
  write_world(corridor, "corridor.world.toml");
  const World world = build_world(read_world("corridor.world.toml"));
  std::printf("%zu segments, %zu surfaces, %.0f %% of the segments repeat\n", world.segments.size(),
              world.surfaces.size(), 100 * repeated_share(world));

  const Visibility visibility(world);
  const Eigen::Vector3d eye(0.5, 1.25, 1.2);
  for (const auto& [what, point] :
       {std::pair{"the nearest door", Eigen::Vector3d(2, 0, 2)},
        std::pair{"the end of the corridor", Eigen::Vector3d(10, 1.3, 1)}}) {
    std::printf("%s is %s\n", what, visibility.sees(eye, point) ? "in sight" : "hidden");
  }

  const World shipped =
      build_world(read_world(std::string(argv[1]) + "/worlds/workshop.world.toml"));
  const WorldExtent box = extent(shipped);
  std::printf("%s: %zu segments in %.1f x %.1f x %.1f m\n", shipped.name.c_str(),
              shipped.segments.size(), box.high_m.x() - box.low_m.x(),
              box.high_m.y() - box.low_m.y(), box.high_m.z() - box.low_m.z());
}
