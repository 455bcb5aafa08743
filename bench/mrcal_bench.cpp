// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// The calibration solver and mrcal's on the same corners, from the same start, for the same model,
// one thread each, each with its own stopping rule (ours stops later: docs/calibration.md). CPU
// time.
#include <benchmark/benchmark.h>

#include <map>

#include "bench/mrcal_problem_set.h"
#include "calib/mrcal/mrcal_problem.h"
#include "calib/mrcal/mrcal_solver.h"
#include "calib/solver/minimise_reprojection.h"
#include "calib/solver/resolve.h"

namespace {

using namespace vernier;
using namespace vernier::internal;

const bench::StereoProblem& problem(int frames) {
  static std::map<int, bench::StereoProblem> problems;
  const auto found = problems.find(frames);
  if (found != problems.end()) return found->second;
  return problems.emplace(frames, bench::stereo_problem(frames)).first->second;
}

void vernier_solve(benchmark::State& state) {
  const bench::StereoProblem& p = problem(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(minimise_reprojection(p.observations, p.start));
}

void vernier_resolve(benchmark::State& state) {
  const bench::StereoProblem& p = problem(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(Resolver(p.observations, p.start).resolve());
  }
}

void mrcal_solve_opencv4(benchmark::State& state) {
  if (!mrcal_available()) {
    state.SkipWithError("this build has no libmrcal");
    return;
  }
  const bench::StereoProblem& p = problem(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(mrcal_optimise_only(p.observations, p.start));
}

void views(benchmark::internal::Benchmark* bench) {
  bench->Arg(40)->Arg(200)->Arg(1000)->Unit(benchmark::kMillisecond)->ArgName("stereo_views");
}

BENCHMARK(vernier_solve)->Apply(views);
BENCHMARK(vernier_resolve)->Apply(views);
BENCHMARK(mrcal_solve_opencv4)->Apply(views);

}  // namespace
