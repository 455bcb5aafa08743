// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// The solver of record beside mrcal's on the same corners, from the same start, for the same model,
// one thread each, each stopping by its own rule (ours later: docs/calibration.md). CPU time.
#include <benchmark/benchmark.h>

#include <map>

#include "calib/minimise_reprojection.h"
#include "calib/mrcal/mrcal_problem.h"
#include "calib/mrcal/mrcal_solver.h"
#include "calib/simulated_board.h"
#include "datasets/shipped.h"

namespace {

using namespace vernier;

struct Problem {
  BoardObservations observations;
  BoardState start;
};

/// 100 corners a view, both cameras see every frame; opencv4.
const Problem& problem(int frames) {
  static std::map<int, Problem> problems;
  const auto found = problems.find(frames);
  if (found != problems.end()) return found->second;
  Rig rig = datasets::nominal_truth();
  for (Camera& camera : rig.cameras) {
    camera.model = OpenCv4{};
    const double k1 = camera.parameters[4];
    camera.parameters.conservativeResize(8);
    camera.parameters.tail<4>() << k1, 0.03, 4e-4, -3e-4;
  }
  const SimulatedBoardOptions options{.frames = frames, .distance_m = 0.8};
  SimulatedBoard board = simulate_board(rig, {10, 10, 0.025}, 5, 0, options);
  Problem made{board.observations, initial_state(board.observations, {OpenCv4{}, OpenCv4{}})};
  return problems.emplace(frames, std::move(made)).first->second;
}

void vernier_solve(benchmark::State& state) {
  const Problem& p = problem(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(minimise_reprojection(p.observations, p.start));
}

void mrcal_solve_opencv4(benchmark::State& state) {
  if (!mrcal_available()) {
    state.SkipWithError("this build has no libmrcal");
    return;
  }
  const Problem& p = problem(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(mrcal_optimise_only(p.observations, p.start));
}

void views(benchmark::internal::Benchmark* bench) {
  bench->Arg(40)->Arg(200)->Arg(1000)->Unit(benchmark::kMillisecond)->ArgName("stereo_views");
}

BENCHMARK(vernier_solve)->Apply(views);
BENCHMARK(mrcal_solve_opencv4)->Apply(views);

}  // namespace
