// How often a robot knows where it is, for calibrations of three qualities.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "calib/interval.h"
#include "calib/rig_file.h"
#include "sim/experiment.h"
#include "sim/world_file.h"

int main(int, char** argv) {
  using namespace vernier;
  using namespace vernier::sim;
  const std::string share = argv[1];
  const RigEstimate rig = read_rig(share + "/rigs/nominal.rig.json").estimate;
  const World world = build_world(read_world(share + "/worlds/workshop.world.toml"));
  const Visibility visibility(world);

  ExperimentSettings settings{.protocol = QueryProtocol::near_path, .map_spacing_m = 2};
  const auto views = std::make_shared<const MapViews>(map_views(visibility, rig.rig, settings));
  for (const double psi_c : {0.1, 1.0, 10.0}) {
    settings.sources.calibration = psi_c;
    const LocalisationExperiment experiment(visibility, rig, views, settings);
    constexpr unsigned maps = 10, trials_each = 4, trials = maps * trials_each;
    std::vector<ClusterCount> of_map(maps);  // a block has a map of its own, with its own errors
    int successes = 0;
    double cpu_ms = 0;
    for (unsigned map = 0; map < maps; ++map) {
      const auto block =
          experiment.run_block({.block = map, .first = map * trials_each, .count = trials_each});
      for (const TrialResult& trial : block) {
        of_map[map].successes += trial.success();
        ++of_map[map].trials;
        cpu_ms += trial.cpu_ms;
      }
      successes += of_map[map].successes;
    }
    // Trials with one map succeed or fail together: the interval is that of fewer ones.
    const double clustering = design_effect(of_map);
    const Interval interval = wilson_interval(successes / clustering, trials / clustering);
    std::printf("psi_c = %4.1f: %2d of %u within 1 m, 95 %% interval [%.2f, %.2f], %.1f ms each\n",
                psi_c, successes, trials, interval.low, interval.high, cpu_ms / trials);
  }
}
