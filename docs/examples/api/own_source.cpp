// A source of error of your own, in line with the standard ones.
#include <cstdio>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "calib/rig_file.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/uncertainty_source.h"
#include "sim/visibility.h"
#include "sim/world_file.h"

namespace {
using namespace vernier;
using namespace vernier::sim;

/// A share of the edges is not detected at all.
class MissedEdges : public UncertaintySource {
 public:
  explicit MissedEdges(double share) : share_(share) {}
  std::string_view name() const override { return "missed_edges"; }

  /// Drawn by what the edge is, never by its place in the list, so that no other draw changes.
  void apply(const SensingContext& context, SensedView& view) const override {
    std::erase_if(view.edges, [&](const SensedEdge& edge) {
      std::seed_seq place{static_cast<std::uint32_t>(context.seed), context.trial, context.frame,
                          edge.truth.feature};
      return 0x1p-32 * std::mt19937(place)() < share_;
    });
  }

 private:
  double share_;
};
}  // namespace

int main(int, char** argv) {
  const std::string share = argv[1];
  const Rig rig = read_rig(share + "/rigs/nominal.rig.json").estimate.rig;
  const World world = build_world(read_world(share + "/worlds/workshop.world.toml"));
  const NoiseFreeView seen = look(Visibility(world), rig, {.x_m = 10, .y_m = 7.5});

  // Registered, it is in studies of this process, and wherever settings name it.
  register_source("missed_edges", [](const SourceOptions& options) {
    return std::make_unique<MissedEdges>(options.at("share"));
  });
  SourceSettings settings;
  settings.own = {{"missed_edges", {{"share", 0.2}}}};
  const StereoObservation sensed = Sensor(rig, settings).sense(seen, {.seed = 1});
  std::printf("%zu edges are sensed\n", sensed.segments.size());

  // One after the other, as Sensor applies them.
  const auto sources = standard_sources(settings, /*min_length_px=*/10);
  SensedView view;
  for (const VisibleEdge& edge : seen.edges) view.edges.emplace_back().truth = edge;
  const stereo::Rectification turned = stereo::rectification(rig);
  std::printf("%-20s %4zu edges\n", "noise-free", view.edges.size());
  for (const auto& source : sources) {
    source->apply({rig, turned, /*seed=*/1, /*trial=*/0, /*frame=*/0}, view);
    std::printf("%-20s %4zu edges\n", std::string(source->name()).c_str(), view.edges.size());
  }
  const stereo::ImageSegment first = image_of(rig, view.edges.at(0), /*eye=*/0);
  std::printf("the first runs from (%.1f, %.1f) to (%.1f, %.1f) in the left image\n",
              first.a_px.x(), first.a_px.y(), first.b_px.x(), first.b_px.y());
}
