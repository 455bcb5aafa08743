// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// Stereo on rendered pairs of 450 x 375 pixels beside OpenCV's three-way SGBM in the same run, one
// thread. The argument is the number of disparities.
#include <benchmark/benchmark.h>

#include <opencv2/core/utility.hpp>

#include "stereo/canny_edges.h"
#include "stereo/dense_matchers.h"
#include "stereo/edge_matcher.h"
#include "stereo/vertical_field.h"
#include "tests/support/leaf_pair.h"

namespace vernier {
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

/// Finding the edges is part of it.
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

void canny(benchmark::State& state) {
  const RectifiedPair pair = scene(64);
  for (auto _ : state) benchmark::DoNotOptimize(canny_edges(pair.left).data());
}
BENCHMARK(canny)->Unit(benchmark::kMillisecond);

void field_and_repair(benchmark::State& state) {
  const RectifiedPair pair = scene(64);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        repaired_right(pair.right, vertical_field(pair, {0, 63})).values.data());
  }
}
BENCHMARK(field_and_repair)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace vernier
