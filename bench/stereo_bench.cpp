// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// Stereo on rendered pairs of 450 x 375 pixels, compared with OpenCV's three-way SGBM in the same
// run, one thread. The argument is the number of disparities.
#include <benchmark/benchmark.h>

#include <opencv2/core/utility.hpp>

#include "stereo/canny_edges.h"
#include "stereo/edge_matcher.h"
#include "stereo/grey_levels.h"
#include "stereo/matching/dense_matchers.h"
#include "stereo/matching/stretch_correlation.h"
#include "stereo/rectification/vertical_field.h"
#include "tests/support/leaf_pair.h"

namespace vernier {

using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

RectifiedPair scene(int disparities) {
  return test::leaf_pair(
      {.width_px = 450, .height_px = 375, .disparity_px = 0.4 * disparities, .by_y = 0.03}, 301);
}

void sgbm_three_ways(benchmark::State& state) {
  cv::setNumThreads(1);
  const auto most = static_cast<int>(state.range(0));
  const RectifiedPair pair = scene(most);
  for (auto _ : state) benchmark::DoNotOptimize(sgbm_map(pair, {0, most - 1}).values.data());
}
BENCHMARK(sgbm_three_ways)->Arg(32)->Arg(64)->Arg(128)->Unit(benchmark::kMillisecond);

/// The same on all cores; wall time. `edge` uses one thread.
void sgbm_all_threads(benchmark::State& state) {
  const auto most = static_cast<int>(state.range(0));
  const RectifiedPair pair = scene(most);
  cv::setNumThreads(-1);
  for (auto _ : state) benchmark::DoNotOptimize(sgbm_map(pair, {0, most - 1}).values.data());
  state.counters["threads"] = cv::getNumThreads();
  cv::setNumThreads(1);
}
BENCHMARK(sgbm_all_threads)
    ->Arg(32)
    ->Arg(64)
    ->Arg(128)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// Edge detection is included.
void edge(benchmark::State& state, bool refine) {
  const auto most = static_cast<int>(state.range(0));
  const RectifiedPair pair = scene(most);
  EdgeMatcherOptions options;
  options.refine = refine;
  std::size_t edges = 0;
  for (auto _ : state) {
    const std::vector<EdgePoint> points = canny_edges(pair.left);
    edges = points.size();
    benchmark::DoNotOptimize(match_edges(pair, points, {0, most - 1}, options).data());
  }
  state.counters["edges"] = static_cast<double>(edges);
}
BENCHMARK_CAPTURE(edge, with_sigma, true)
    ->Arg(32)
    ->Arg(64)
    ->Arg(128)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(edge, support_alone, false)
    ->Arg(32)
    ->Arg(64)
    ->Arg(128)
    ->Unit(benchmark::kMillisecond);

/// Growth of the time with width (height is 5/6 of it), number of disparities, and the minimum
/// radius of the leaves, which determines the number of edges. Drawn by
/// scripts/plot_stereo_growth.py.
template <class Work>
void growth(benchmark::State& state, const Work& work) {
  cv::setNumThreads(1);
  const auto width = static_cast<int>(state.range(0)), most = static_cast<int>(state.range(1));
  const auto radius = static_cast<double>(state.range(2));
  const RectifiedPair pair = test::leaf_pair({.width_px = width,
                                              .height_px = width * 5 / 6,
                                              .disparity_px = 0.4 * most,
                                              .by_y = 0.03,
                                              .min_radius_px = radius,
                                              .max_radius_px = 5 * radius},
                                             302);
  const std::vector<EdgePoint> edges = canny_edges(pair.left);
  state.counters["edges"] = static_cast<double>(edges.size());
  for (auto _ : state) work(pair, edges, DisparityRange{0, most - 1});
}

void growth_arguments(benchmark::internal::Benchmark* bench) {
  for (const int width : {150, 225, 300, 450, 600, 900}) bench->Args({width, 64, 6});
  for (const int disparities : {16, 32, 128, 256}) bench->Args({450, disparities, 6});
  for (const int radius : {2, 4, 12, 25, 50}) bench->Args({450, 64, radius});
  bench->ArgNames({"width", "disparities", "radius"})->Unit(benchmark::kMillisecond);
}

void grow_sgbm(benchmark::State& state) {
  growth(state, [](const RectifiedPair& pair, const auto&, const DisparityRange& range) {
    benchmark::DoNotOptimize(sgbm_map(pair, range).values.data());
  });
}
BENCHMARK(grow_sgbm)->Apply(growth_arguments);

void grow_edge(benchmark::State& state) {
  growth(state, [](const RectifiedPair& pair, const auto&, const DisparityRange& range) {
    benchmark::DoNotOptimize(match_edges(pair, canny_edges(pair.left), range).data());
  });
}
BENCHMARK(grow_edge)->Apply(growth_arguments);

void grow_stretch(benchmark::State& state) {
  growth(state, [](const RectifiedPair& pair, const auto&, const DisparityRange& range) {
    benchmark::DoNotOptimize(stretch_matcher().match(pair, canny_edges(pair.left), range).data());
  });
}
BENCHMARK(grow_stretch)->Apply(growth_arguments);

void canny(benchmark::State& state) {
  const RectifiedPair pair = scene(64);
  for (auto _ : state) benchmark::DoNotOptimize(canny_edges(pair.left).data());
}
BENCHMARK(canny)->Unit(benchmark::kMillisecond);

void field_and_repair(benchmark::State& state) {
  const RectifiedPair pair = scene(64);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        corrected_right(pair.right, vertical_field(pair, {0, 63})).values.data());
  }
}
BENCHMARK(field_and_repair)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace vernier
