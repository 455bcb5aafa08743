// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Histogram comparison: the SIMD kernel, the plain loop of square roots that follows directly from
// the definition of the Bhattacharyya coefficient, and Eigen's matrix product; then a complete
// query.
#include <benchmark/benchmark.h>

#include <cmath>
#include <ctime>

#include "calib/base/instruction_set.h"
#include "calib/rig_estimate.h"
#include "calib/statistics/random.h"
#include "datasets/shipped.h"
#include "localise/histograms/best_matches.h"
#include "localise/localiser.h"
#include "localise/pgh.h"
#include "localise/place.h"
#include "sim/experiment.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace {

using namespace vernier;
using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::localise::internal;
using namespace vernier::sim;

/// 80 query lines against 80 node lines, 720 bins, as with the default options.
HistogramRows rows(std::uint64_t seed, int count) {
  HistogramRows H(count, 720);
  RandomStream draws({.seed = seed});
  for (Eigen::Index i = 0; i < H.size(); ++i) H.data()[i] = static_cast<float>(draws.uniform());
  for (int r = 0; r < count; ++r) H.row(r).normalize();
  return H;
}

void kernel(benchmark::State& state) {
  const HistogramRows Q = rows(1, 80), S = rows(2, 80);
  for (auto _ : state) benchmark::DoNotOptimize(best_matches(Q, S));
  state.SetLabel(std::string(instruction_set()));
}

void eigen_product(benchmark::State& state) {
  const HistogramRows Q = rows(1, 80), S = rows(2, 80);
  for (auto _ : state) {
    const HistogramRows G = Q * S.transpose();
    Eigen::VectorXf a = G.rowwise().maxCoeff(), b = G.colwise().maxCoeff();
    benchmark::DoNotOptimize(a.data());
    benchmark::DoNotOptimize(b.data());
  }
}

void plain_square_roots(benchmark::State& state) {
  const HistogramRows Q = rows(1, 80).cwiseAbs2(), S = rows(2, 80).cwiseAbs2();
  for (auto _ : state) {
    Eigen::VectorXf best = Eigen::VectorXf::Zero(80);
    for (int q = 0; q < 80; ++q) {
      for (int s = 0; s < 80; ++s) {
        float sum = 0;
        for (int k = 0; k < 720; ++k) sum += std::sqrt(Q(q, k) * S(s, k));
        best[q] = std::max(best[q], sum);
      }
    }
    benchmark::DoNotOptimize(best.data());
  }
}

BENCHMARK(kernel)->Unit(benchmark::kMicrosecond);
BENCHMARK(eigen_product)->Unit(benchmark::kMicrosecond);
BENCHMARK(plain_square_roots)->Unit(benchmark::kMicrosecond);

/// The shipped world, its map and ten queries.
struct Scene {
  World world = build_world(datasets::workshop());
  Visibility visibility{world};
  RigEstimate rig = datasets::nominal();
  ExperimentSettings settings;
  std::unique_ptr<LocalisationExperiment> experiment;
  TopologicalMap map;
  std::vector<PlaceView> queries;

  Scene() {
    settings.protocol = QueryProtocol::near_path;
    auto looks = std::make_shared<MapViews>(map_views(visibility, rig.rig, settings));
    experiment = std::make_unique<LocalisationExperiment>(visibility, rig, looks, settings);
    map = experiment->record_map(0, rig.rig);
    for (int i = 0; i < 10; ++i) queries.push_back(map.nodes[17 * i].view);
  }
};

const Scene& scene() {
  static const Scene scene;
  return scene;
}

void histograms_of_a_view(benchmark::State& state) {
  scene();
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(spatial_histograms(scene().queries[i++ % 10].lines));
  }
}

void whole_query(benchmark::State& state, const char* method) {
  const auto localiser = make_localiser(method, scene().map);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(localiser->localise(scene().queries[i++ % 10]));
  }
}

/// CPU time of a process.
double cpu_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// The same queries in turn with the baseline in plain loops and vectorised.
void baseline_vectorised_against_plain(benchmark::State& state) {
  const auto plain = make_localiser("pgh_baseline", scene().map);
  const auto vectorised = make_localiser("pgh_baseline_vectorised", scene().map);
  double plain_ms = 0, vectorised_ms = 0;
  std::size_t i = 0;
  for (auto _ : state) {
    const PlaceView& query = scene().queries[i++ % 10];
    const double start = cpu_ms();
    benchmark::DoNotOptimize(plain->localise(query));
    const double middle = cpu_ms();
    benchmark::DoNotOptimize(vectorised->localise(query));
    plain_ms += middle - start;
    vectorised_ms += cpu_ms() - middle;
  }
  state.counters["plain_ms"] = plain_ms / static_cast<double>(i);
  state.counters["vectorised_ms"] = vectorised_ms / static_cast<double>(i);
  state.counters["times_faster"] = plain_ms / vectorised_ms;
}

BENCHMARK(histograms_of_a_view)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(whole_query, pgh, "pgh")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(whole_query, pgh_baseline, "pgh_baseline")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(whole_query, pgh_baseline_vectorised, "pgh_baseline_vectorised")
    ->Unit(benchmark::kMillisecond);
BENCHMARK(baseline_vectorised_against_plain)->Unit(benchmark::kMillisecond)->Iterations(20);

}  // namespace
