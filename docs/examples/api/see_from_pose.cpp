// What a rig sees of a world from a pose, without and with the known sources of error.
#include <cstdio>
#include <string>
#include <utility>

#include "calib/rig_file.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/visibility.h"
#include "sim/world_file.h"

int main(int, char** argv) {
  using namespace vernier;
  using namespace vernier::sim;
  const std::string share = argv[1];
  const Rig rig = read_rig(share + "/rigs/nominal.rig.json").estimate.rig;
  const World world = build_world(read_world(share + "/worlds/workshop.world.toml"));
  const Visibility visibility(world);

  const localise::Pose2D pose{.x_m = 10, .y_m = 7.5, .heading_rad = 0};
  const NoiseFreeView view =
      look(visibility, rig, pose, {.mount = {.height_m = 1.2}, .with_corners = true});
  std::printf("both eyes see %zu edges and %zu corners\n", view.edges.size(), view.corners.size());

  SourceSettings only_loss = no_sources(), defaults;
  only_loss.edge_loss = 0.1125;
  for (const auto& [what, settings] :
       {std::pair{"without sources", no_sources()}, std::pair{"edge loss alone", only_loss},
        std::pair{"all at their defaults", defaults}}) {
    const Sensor sensor(rig, settings);
    const StereoObservation seen = sensor.sense(view, {.seed = 1});
    double length_px = 0;
    for (const stereo::StereoSegment& segment : seen.segments) {
      length_px += segment.left.length_px();
    }
    std::printf("%-22s %4zu segments of %6.0f px in all, %4zu corners\n", what,
                seen.segments.size(), length_px, seen.corners.size());
  }
}
