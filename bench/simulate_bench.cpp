// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Cost of a simulated view, by part.
#include <benchmark/benchmark.h>

#include "calib/pose.h"
#include "calib/rig_estimate.h"
#include "datasets/shipped.h"
#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/study/ceiling.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace {

using namespace vernier;
using namespace vernier::localise;
using namespace vernier::sim;
using namespace vernier::sim::internal;

const World& world() {
  static const World world = build_world(datasets::workshop());
  return world;
}
const Visibility& visibility() {
  static const Visibility visibility(world());
  return visibility;
}
const RigEstimate& rig() {
  static const RigEstimate rig = datasets::nominal();
  return rig;
}
const std::vector<Pose2D>& places() {
  static const std::vector<Pose2D> places = map_poses(world().route, 0.5);
  return places;
}

void hidden_lines_of_one_eye(benchmark::State& state) {
  std::size_t i = 0;
  for (auto _ : state) {
    const Pose T = T_left_world(places()[i++ % places().size()], {});
    benchmark::DoNotOptimize(visibility().visible_intervals(rig().rig.cameras[0], T));
  }
}

void look_of_both_eyes(benchmark::State& state) {
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(look(visibility(), rig().rig, places()[i++ % places().size()]));
  }
}

void all_sources(benchmark::State& state) {
  const Sensor sensor(rig().rig, {});
  const NoiseFreeView seen = look(visibility(), rig().rig, places()[40]);
  std::uint32_t trial = 0;
  for (auto _ : state) benchmark::DoNotOptimize(sensor.sense(seen, {.trial = trial++}));
}

// Both eyes with exact visibility, and all sources that are on.
void frame(benchmark::State& state, const SourceSettings& sources) {
  const Sensor sensor(rig().rig, sources);
  std::uint32_t trial = 0;
  for (auto _ : state) {
    const NoiseFreeView seen = look(visibility(), rig().rig, places()[trial % places().size()]);
    benchmark::DoNotOptimize(sensor.sense(seen, {.trial = trial}));
    ++trial;
  }
}

void frame_with_the_default_sources(benchmark::State& state) { frame(state, {}); }

void frame_with_every_source(benchmark::State& state) {
  SourceSettings sources;
  sources.clutter = 0.2;
  sources.merge_px = 3;
  frame(state, sources);
}

void aliases_of_a_pose(benchmark::State& state) {
  const AliasFinder finder(visibility(), rig().rig, {});
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(finder.aliases(places()[i++ % places().size()]));
  }
}

BENCHMARK(hidden_lines_of_one_eye)->Unit(benchmark::kMillisecond);
BENCHMARK(look_of_both_eyes)->Unit(benchmark::kMillisecond);
BENCHMARK(all_sources)->Unit(benchmark::kMillisecond);
BENCHMARK(frame_with_the_default_sources)->Unit(benchmark::kMillisecond);
BENCHMARK(frame_with_every_source)->Unit(benchmark::kMillisecond);
BENCHMARK(aliases_of_a_pose)->Unit(benchmark::kMillisecond);

}  // namespace
