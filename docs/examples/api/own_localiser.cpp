// A localiser of your own, on a map recorded by the simulated robot, beside the one that ships.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "calib/rig_file.h"
#include "localise/localiser.h"
#include "localise/pgh.h"
#include "sim/experiment.h"
#include "sim/world_file.h"

namespace {
using namespace vernier;
using namespace vernier::localise;

/// Answers the map's node whose histograms are most like the query's, and its pose unrefined.
class MostAlike : public Localiser {
 public:
  explicit MostAlike(const TopologicalMap& map) : map_(map) {
    for (const MapNode& node : map.nodes) {
      histograms_.push_back(spatial_histograms(node.view.lines));
    }
  }
  LocalisationAnswer localise(const PlaceView& query) const override {
    LocalisationAnswer answer;
    if (query.lines.size() < 6) return answer;  // status: too_few_lines
    const Pgh lines = spatial_histograms(query.lines);
    for (std::size_t i = 0; i < map_.nodes.size(); ++i) {
      if (histograms_[i].rows.rows() == 0) continue;
      const HistogramRows likeness = lines.rows * histograms_[i].rows.transpose();
      const double score = likeness.rowwise().maxCoeff().mean();
      if (score > answer.score) {
        answer.node = static_cast<int>(i);
        answer.score = score;
      }
    }
    if (answer.node < 0) return answer;
    answer.status = LocalisationStatus::answered;
    answer.pose = map_.nodes[answer.node].pose;
    return answer;
  }

 private:
  const TopologicalMap& map_;
  std::vector<Pgh> histograms_;
};
}  // namespace

int main(int, char** argv) {
  const std::string share = argv[1];
  const RigEstimate rig = read_rig(share + "/rigs/nominal.rig.json").estimate;
  const sim::World world = sim::build_world(sim::read_world(share + "/worlds/workshop.world.toml"));
  const sim::Visibility visibility(world);
  const sim::ExperimentSettings settings{.map_spacing_m = 2};
  const auto views =
      std::make_shared<const sim::MapViews>(sim::map_views(visibility, rig.rig, settings));
  const sim::LocalisationExperiment robot(visibility, rig, views, settings);

  // The same route driven twice: the first drive is the map, every fourth place of the second asks.
  const TopologicalMap map = robot.record_map(0, robot.map_estimator_rig(0));
  const TopologicalMap again = robot.record_map(1, robot.map_estimator_rig(1));
  const MostAlike mine(map);
  const auto shipped = make_localiser("pgh", map);
  for (const Localiser* localiser : std::vector<const Localiser*>{&mine, shipped.get()}) {
    int asked = 0, right = 0;
    for (std::size_t i = 0; i < again.nodes.size(); i += 4, ++asked) {
      const LocalisationAnswer answer = localiser->localise(again.nodes[i].view);
      right += answer.status == LocalisationStatus::answered &&
               distance_m(answer.pose, again.nodes[i].pose) <= 1;
    }
    std::printf("%s: %d of %d within 1 m\n", localiser == &mine ? "mine" : "pgh", right, asked);
  }
}
